#include "frontend/places/place_database.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/core/hal/hal.hpp>
#include <string>

#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kBytes = 32;  // per descriptor

// Two views of the same feature may differ in this many of the 256 bits.
// Unrelated descriptors differ in 128 on average.
constexpr int kMaxDistance = 50;

// Entries per bucket, mean and maximum. A full bucket keeps the oldest
// keyframes, as they help a graph most. Features seen everywhere are useless.
constexpr size_t kMeanLoad = 2;
constexpr int kMaxLoad = 32;

constexpr int kEnd = -1;          // of a bucket's list
constexpr int kNotInBucket = -2;  // not in the bucket, which was full

void Require(const cv::Mat& descriptors) {
  if (!descriptors.empty() &&
      (descriptors.type() != CV_8UC1 || descriptors.cols != kBytes)) {
    throw InputError("a place index takes ORB descriptors, rows of " +
                     std::to_string(kBytes) + " bytes, not of " +
                     std::to_string(descriptors.cols));
  }
}

}  // namespace

size_t PlaceDatabase::Table::Number(uint32_t word) const {
  const uint32_t bucket = word & ((1u << bits) - 1u);
  return bucket < split ? word & ((2u << bits) - 1u) : bucket;
}

// Moves about half of the entries of the next bucket to a new bucket.
void PlaceDatabase::Split(int word) {
  Table& table = tables_[word];
  table.buckets.emplace_back();
  int entry = table.buckets[table.split].first;
  table.buckets[table.split] = Bucket();
  if (++table.split == 1u << table.bits) {
    table.split = 0;
    ++table.bits;
  }
  while (entry != kEnd) {
    Entry& moved = At(entry);
    Bucket& bucket = table.Of(moved.words[word]);
    const int next = moved.next[word];
    moved.next[word] = bucket.first;
    bucket.first = entry;
    ++bucket.size;
    entry = next;
  }
}

void PlaceDatabase::Add(int keyframe, const cv::Mat& descriptors) {
  Require(descriptors);
  if (blocks_of_.count(keyframe) > 0) {
    throw InputError("keyframe " + std::to_string(keyframe) +
                     " is in the place index already");
  }
  if (free_blocks_.empty()) {
    free_blocks_.push_back(static_cast<int>(blocks_.size()));
    blocks_.emplace_back();
  }
  const int block = free_blocks_.back();
  free_blocks_.pop_back();
  blocks_of_[keyframe] = block;
  Block& entries = blocks_[block];
  entries.resize(std::min(descriptors.rows, kMaxDescriptors));
  for (size_t i = 0; i < entries.size(); ++i) {
    const size_t row = i * descriptors.rows / entries.size();
    std::memcpy(&entries[i].words, descriptors.ptr(static_cast<int>(row)),
                kBytes);
    ++num_entries_;
    for (int word = 0; word < kWords; ++word) {
      Table& table = tables_[word];
      Bucket& bucket = table.Of(entries[i].words[word]);
      const bool is_full = bucket.size >= kMaxLoad;
      entries[i].next[word] = is_full ? kNotInBucket : bucket.first;
      if (!is_full) {
        bucket.first = block * kMaxDescriptors + static_cast<int>(i);
        ++bucket.size;
      }
      if (num_entries_ > kMeanLoad * table.buckets.size()) Split(word);
    }
  }
}

void PlaceDatabase::Remove(int keyframe) {
  const auto found = blocks_of_.find(keyframe);
  if (found == blocks_of_.end()) return;
  const int block = found->second;
  Block& entries = blocks_[block];
  for (size_t i = 0; i < entries.size(); ++i) {
    const int entry = block * kMaxDescriptors + static_cast<int>(i);
    for (int word = 0; word < kWords; ++word) {
      if (entries[i].next[word] == kNotInBucket) continue;
      Bucket& bucket = tables_[word].Of(entries[i].words[word]);
      int* link = &bucket.first;
      while (*link != entry) link = &At(*link).next[word];
      *link = entries[i].next[word];
      --bucket.size;
    }
  }
  num_entries_ -= entries.size();
  entries.clear();
  free_blocks_.push_back(block);
  blocks_of_.erase(found);
}

void PlaceDatabase::FindAlike(const uint8_t* descriptor, int mark,
                              std::vector<int>* marks,
                              std::vector<int>* blocks) const {
  Descriptor words;
  static_assert(sizeof(words) == kBytes, "all of it");
  std::memcpy(&words, descriptor, kBytes);
  std::array<int, kWords> next;
  for (int word = 0; word < kWords; ++word) {
    next[word] = tables_[word].Of(words[word]).first;
  }
  // All buckets in turn: while one entry is compared, others are prefetched.
  for (bool is_done = false; !is_done;) {
    is_done = true;
    for (int word = 0; word < kWords; ++word) {
      if (next[word] == kEnd) continue;
      is_done = false;
      const int block = next[word] / kMaxDescriptors;
      const Entry& entry = At(next[word]);
      next[word] = entry.next[word];
      if (next[word] != kEnd) __builtin_prefetch(&At(next[word]));
      if ((*marks)[block] == mark) continue;
      const auto* other = reinterpret_cast<const uchar*>(entry.words.data());
      if (cv::hal::normHamming(descriptor, other, kBytes) > kMaxDistance)
        continue;
      (*marks)[block] = mark;
      blocks->push_back(block);
    }
  }
}

std::vector<PlaceCandidate> PlaceDatabase::Query(
    const cv::Mat& descriptors, int most,
    const std::function<bool(int keyframe)>& filter) const {
  Require(descriptors);
  std::vector<double> scores(blocks_.size(), 0.0);
  std::vector<int> marks(blocks_.size(), -1);
  std::vector<int> alike;
  // A feature in n of N keyframes has the weight log((N + 1) / max(n, 1)).
  const double all = size() + 1.0;
  double total = 0.0;
  for (int row = 0; row < descriptors.rows; ++row) {
    alike.clear();
    FindAlike(descriptors.ptr(row), row, &marks, &alike);
    const double weight = std::log(
        all / std::max<double>(1.0, static_cast<double>(alike.size())));
    total += weight;
    for (const int block : alike) scores[block] += weight;
  }
  std::vector<PlaceCandidate> candidates;
  for (const auto& [keyframe, block] : blocks_of_) {
    if (scores[block] > 0.0 && (!filter || filter(keyframe))) {
      candidates.push_back({keyframe, scores[block] / total});
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const PlaceCandidate& a, const PlaceCandidate& b) {
                     return a.score > b.score;
                   });
  candidates.resize(std::min<size_t>(candidates.size(), std::max(most, 0)));
  return candidates;
}

}  // namespace rgbd_pose
