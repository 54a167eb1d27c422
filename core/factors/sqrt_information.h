#pragma once

#include "core/util/small_matrix.h"

namespace rgbd_pose {

// S with S^T S = information, for a symmetric matrix of at most 7 x 7 that may
// be singular: what is not known has no weight. NaN if it is not positive
// semi-definite.
SmallMatrix SqrtInformation(const SmallMatrix& information);

// S with S^T S = covariance^-1. Throws InputError if the covariance is not
// finite, symmetric and positive definite.
SmallMatrix SqrtInformationOfCovariance(const SmallMatrix& covariance);

}  // namespace rgbd_pose
