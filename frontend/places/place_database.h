#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// A keyframe that may show what a frame shows.
struct PlaceCandidate {
  int keyframe = 0;    // as it was added
  double score = 0.0;  // 0 to 1: the share of what the frame's features tell
                       // that the keyframe has as well
};

// Finds keyframes that look like a frame, by its ORB descriptors alone: nothing
// is trained or loaded. Descriptors are hashed by each of their eight words of
// 32 bits (locality-sensitive hashing, Indyk & Motwani 1998), so that one whose
// bits are nearly the same shares a bucket with it in most cases. A feature
// counts the more, the fewer keyframes have it (inverse document frequency,
// Sparck Jones 1972), and one that is everywhere does not count at all.
//
// Buckets multiply as keyframes come, one by one (linear hashing, Litwin 1980):
// neither the time of a query nor that of an addition grows with the number of
// keyframes but by misses of the cache. The same calls give the same results.
// Queries may be made from several threads at once.
class PlaceDatabase {
 public:
  // Of a keyframe, at most so many descriptors are taken, evenly spread over
  // the rows.
  static constexpr int kMaxDescriptors = 400;

  // `descriptors`: CV_8U, n x 32, a row each. Throws InputError for others, or
  // for a keyframe that is there already.
  void Add(int keyframe, const cv::Mat& descriptors);

  // What it took serves the next one. Nothing happens if it is not there.
  void Remove(int keyframe);

  // The keyframes most alike, the best first; at most so many, of those that
  // `filter` takes (null: all). Throws InputError for other descriptors.
  std::vector<PlaceCandidate> Query(
      const cv::Mat& descriptors, int most,
      const std::function<bool(int keyframe)>& filter = nullptr) const;

  // How many keyframes are there.
  int size() const { return static_cast<int>(blocks_of_.size()); }

 private:
  static constexpr int kWords = 8;
  using Descriptor = std::array<uint32_t, kWords>;

  // One descriptor and, for each of its words, the next of the bucket: a line
  // of the cache.
  struct Entry {
    Descriptor words;
    std::array<int, kWords> next;
  };
  // Those of a keyframe. Entry i of block b is number b * kMaxDescriptors + i.
  struct Block {
    int keyframe = 0;
    std::vector<Entry> entries;
  };
  struct Bucket {
    int first = -1;  // entry; -1: none
    int size = 0;
  };
  // The buckets of one word. Those before `split` have been split since there
  // were 2^bits of them.
  struct Table {
    std::vector<Bucket> buckets = {Bucket()};
    uint32_t split = 0;
    uint32_t bits = 0;

    Bucket& Of(uint32_t word) { return buckets[Number(word)]; }
    const Bucket& Of(uint32_t word) const { return buckets[Number(word)]; }
    size_t Number(uint32_t word) const;
  };

  Entry& At(int entry) {
    return blocks_[entry / kMaxDescriptors].entries[entry % kMaxDescriptors];
  }
  const Entry& At(int entry) const {
    return blocks_[entry / kMaxDescriptors].entries[entry % kMaxDescriptors];
  }
  void Split(int word);
  // Appends the blocks that have a descriptor like this one, each once:
  // `marks` holds `mark` for those that are in.
  void FindAlike(const Descriptor& descriptor, int mark,
                 std::vector<int>* marks, std::vector<int>* blocks) const;

  std::vector<Block> blocks_;
  std::vector<int> free_blocks_;
  std::map<int, int> blocks_of_;  // by keyframe
  std::array<Table, kWords> tables_;
  size_t num_entries_ = 0;
};

}  // namespace rgbd_pose
