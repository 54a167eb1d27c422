#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// A keyframe that may show the same place as a frame.
struct PlaceCandidate {
  int keyframe = 0;    // number passed to Add
  double score = 0.0;  // 0 to 1: share of the weight of all the frame's
                       // features that the keyframe has as well
};

// Finds the keyframes that look like a frame, by ORB descriptors alone: nothing
// is trained or loaded. Each 32-bit word of a descriptor is a hash key
// (locality-sensitive hashing, Indyk & Motwani 1998). A feature has a higher
// weight, the fewer keyframes have it (inverse document frequency, Sparck Jones
// 1972). Buckets are split one by one as keyframes are added (linear hashing,
// Litwin 1980), so larger maps do not take longer, except through cache misses.
// The same calls give the same results. Several threads may call Query at once.
class PlaceDatabase {
 public:
  // At most this many descriptors of a keyframe, spread evenly, are stored.
  static constexpr int kMaxDescriptors = 400;

  // `descriptors`: CV_8U, n x 32, one per row. Throws InputError for another
  // format or if the keyframe has been added already.
  void Add(int keyframe, const cv::Mat& descriptors);

  // Does nothing if the keyframe is unknown. The next one reuses its memory.
  void Remove(int keyframe);

  // The most similar keyframes, best first: at most `most` of those that
  // `filter` accepts (null: all). Throws InputError for another format.
  std::vector<PlaceCandidate> Query(
      const cv::Mat& descriptors, int most,
      const std::function<bool(int keyframe)>& filter = nullptr) const;

  // Number of keyframes.
  int size() const { return static_cast<int>(blocks_of_.size()); }

 private:
  static constexpr int kWords = 8;
  using Descriptor = std::array<uint32_t, kWords>;

  // A descriptor and, by word, the next entry in the bucket: a cache line.
  struct Entry {
    Descriptor words;
    std::array<int, kWords> next;
  };
  // The entries of a keyframe: b * kMaxDescriptors + i is entry i of block b.
  using Block = std::vector<Entry>;
  struct Bucket {
    int first = -1;  // number of the first entry; -1: none
    int size = 0;
  };
  // The hash table of one word, with 2^bits + split buckets: in this round
  // those before `split` have been split.
  struct Table {
    std::vector<Bucket> buckets = {Bucket()};
    uint32_t split = 0;
    uint32_t bits = 0;

    Bucket& Of(uint32_t word) { return buckets[Number(word)]; }
    const Bucket& Of(uint32_t word) const { return buckets[Number(word)]; }
    size_t Number(uint32_t word) const;
  };

  Entry& At(int entry) {
    return blocks_[entry / kMaxDescriptors][entry % kMaxDescriptors];
  }
  const Entry& At(int entry) const {
    return blocks_[entry / kMaxDescriptors][entry % kMaxDescriptors];
  }
  void Split(int word);
  // Appends each block that has a similar descriptor once; the blocks that are
  // already in have `mark` in `marks`.
  void FindAlike(const uint8_t* descriptor, int mark, std::vector<int>* marks,
                 std::vector<int>* blocks) const;

  std::vector<Block> blocks_;
  std::vector<int> free_blocks_;
  std::map<int, int> blocks_of_;  // by keyframe
  std::array<Table, kWords> tables_;
  size_t num_entries_ = 0;
};

}  // namespace rgbd_pose
