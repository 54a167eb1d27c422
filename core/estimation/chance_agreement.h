#pragma once

#include <vector>

namespace rgbd_pose {

// How a match agrees with a motion.
struct MatchAgreement {
  double width = 0.0;  // norm of its residual, in limits of the noise's 99 %
  int rows = 0;        // independent measurements
};

// How many sets of matches that agree as well with one motion are expected by
// chance, if all matches are wrong: the number of false alarms of Moisan and
// Stival (Int. J. Computer Vision 57, 2004), the least over all widths,
//
//   (n - m) C(n, k) C(k, m) (w / R)^(rows (k - m)),
//
// for the k best of n matches, the m of them that determine six rows, their
// width w, and the extent R of the residuals of wrong matches: as large as
// those of the matches that do not agree, and at least ten times the limit.
// Rows are those of the match that has the fewest. Infinite if no match is
// left to confirm a motion. `agreements`, whose order changes, has all matches
// that are used; those up to `limit` agree. `parameters`: how many of the six
// the matches determine, where a prior determines the others.
double FalseAlarms(double limit, int parameters,
                   std::vector<MatchAgreement>* agreements);

// R of FalseAlarms, in limits: how far the residuals of wrong matches extend.
// `median_width` is that of the matches that do not agree, `rows` their rows.
double ExtentOfWrong(double median_width, double rows);

}  // namespace rgbd_pose
