#include "core/util/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <numeric>

namespace rgbd_pose {
namespace {

int Lower(char letter) {
  return std::tolower(static_cast<unsigned char>(letter));
}

// The number of letters to insert, delete or replace.
int EditDistance(const std::string& a, const std::string& b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    int diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const int changed = diagonal + (Lower(a[i]) != Lower(b[j]) ? 1 : 0);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string NearestName(const std::string& name,
                        const std::vector<std::string>& names, int most) {
  std::string nearest;
  for (const std::string& other : names) {
    const int distance = EditDistance(name, other);
    if (distance > most) continue;
    most = distance - 1;
    nearest = other;
  }
  return nearest;
}

}  // namespace rgbd_pose
