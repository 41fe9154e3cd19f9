// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig.h"

#include <Eigen/LU>
#include <opencv2/core.hpp>
#include <opencv2/core/eigen.hpp>
#include <ostream>
#include <vector>

#include "files/storage_file.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "setup/lens_entry.h"

namespace palpate::sensing {
namespace {

/// R counts as a rotation if no entry of R^T R - I exceeds this: far above the rounding of numbers
/// with seven digits, and far below an error that moves a point at 1 m by a tenth of a millimetre.
constexpr double kRotationTolerance = 1e-5;

/// Largest entry of the inverse of a colour mixing, by which noise grows.
constexpr double kMostUnmixing = 10;

void check_chromatic(const ChromaticShift& shift, const std::string& what) {
  require(what + ".alpha", shift.alpha, above(0).finite());
  require(what + ".beta", shift.beta, above(0).finite());
  require(what + ".gamma", shift.gamma, finite());
}

/// Empty if there is none.
YAML::Node find_chromatic(const StorageFile& file) {
  const YAML::Node chromatic = file.find(file.root(), "chromatic");
  if (!chromatic) return YAML::Node(YAML::NodeType::Map);
  if (!chromatic.IsMap())
    file.fail("chromatic", "red and blue, each with alpha, beta and gamma, are expected");
  file.allow_only(chromatic, {"red", "blue", "mixing"}, "chromatic.");
  return chromatic;
}

ChromaticShift read_chromatic(const StorageFile& file, const YAML::Node& chromatic,
                              const std::string& channel) {
  const YAML::Node found = file.find(chromatic, channel);
  if (!found) return {};
  const std::string key = "chromatic." + channel;
  const auto value = [&](const char* name) {
    return file.number(file.child(found, name, key + "."), key + "." + name);
  };
  const ChromaticShift shift{
      .alpha = value("alpha"), .beta = value("beta"), .gamma = value("gamma")};
  if (!(shift.alpha > 0) || !(shift.beta > 0)) file.fail(key, "alpha and beta must be > 0");
  return shift;
}

Eigen::Matrix3d read_mixing(const StorageFile& file, const YAML::Node& chromatic) {
  Eigen::Matrix3d mixing = Eigen::Matrix3d::Identity();
  const YAML::Node found = file.find(chromatic, "mixing");
  if (!found) return mixing;
  const std::string key = "chromatic.mixing";
  const std::vector<double> values = file.numbers(found, key);
  if (values.size() != 9) file.fail(key, "nine numbers, row by row, are expected");
  for (int i = 0; i < 9; ++i) mixing(i / 3, i % 3) = values[static_cast<std::size_t>(i)];
  return mixing;
}

Eigen::Isometry3d read_pose(const StorageFile& file) {
  const cv::Mat_<double> R = file.matrix("R");
  if (R.rows != 3 || R.cols != 3) file.fail("R", "a 3 x 3 matrix is expected");
  const cv::Mat_<double> t = file.matrix("t");
  if (t.total() != 3 || (t.rows != 1 && t.cols != 1)) file.fail("t", "three values are expected");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.linear()(row, column) = R(row, column);
    pose.translation()[row] = t.begin()[row];
  }
  return pose;
}

std::optional<RigCovariance> read_covariance(const StorageFile& file) {
  if (!file.find(file.root(), "covariance")) return std::nullopt;
  const cv::Mat_<double> values = file.matrix("covariance");
  if (values.rows != kRigParameters || values.cols != kRigParameters) {
    file.fail("covariance", "has " + std::to_string(values.rows) + " x " +
                                std::to_string(values.cols) +
                                " values; a matrix of 24 x 24 is expected");
  }
  RigCovariance covariance;
  for (int row = 0; row < kRigParameters; ++row)
    for (int column = 0; column < kRigParameters; ++column)
      covariance(row, column) = values(row, column);
  return covariance;
}

void check_covariance(const RigCovariance& covariance, const std::string& what) {
  // Files of other programs may have few digits.
  constexpr double kAsymmetry = 1e-6;
  const double largest = covariance.cwiseAbs().maxCoeff();
  if (!covariance.allFinite() || !(covariance.diagonal().minCoeff() >= 0) ||
      !((covariance - covariance.transpose()).cwiseAbs().maxCoeff() <= kAsymmetry * largest)) {
    throw InvalidInput(what +
                       ": covariance: must be finite and symmetric, with variances >= 0 on its "
                       "diagonal; without the node, the rig counts as exact");
  }
}

void write_chromatic(cv::FileStorage& storage, const char* name, const ChromaticShift& shift) {
  storage << name << "{"
          << "alpha" << shift.alpha << "beta" << shift.beta << "gamma" << shift.gamma << "}";
}

void write_mixing(cv::FileStorage& storage, const Eigen::Matrix3d& mixing) {
  if (mixing.isIdentity(0)) return;
  storage << "mixing"
          << "[";
  for (int i = 0; i < 9; ++i) storage << mixing(i / 3, i % 3);
  storage << "]";
}

void check_mixing(const Eigen::Matrix3d& mixing, const std::string& what) {
  const bool relative = (mixing.diagonal().array() == 1).all();
  if (!mixing.allFinite() || !relative ||
      !(mixing.inverse().cwiseAbs().maxCoeff() <= kMostUnmixing)) {
    throw InvalidInput(what +
                       ": must be a matrix of finite numbers with ones on its diagonal that can be "
                       "inverted; palpate calibrate crosstalk makes it");
  }
}

}  // namespace

void check_rig(const Rig& rig, const std::string& what) {
  geometry::check_camera(rig.camera, (what + ": camera").c_str());
  geometry::check_camera(rig.projector, (what + ": projector").c_str());
  const Eigen::Matrix3d R = rig.T_projector_camera.linear();
  const Eigen::Vector3d t = rig.T_projector_camera.translation();
  if (!R.allFinite() || !t.allFinite()) throw InvalidInput(what + ": R and t must be finite");
  const Eigen::Matrix3d rest = R.transpose() * R - Eigen::Matrix3d::Identity();
  if (!(rest.cwiseAbs().maxCoeff() <= kRotationTolerance) || !(R.determinant() > 0)) {
    throw InvalidInput(what + ": R: not a rotation (R^T R must be the identity, det R = 1)");
  }
  if (t.isZero(0)) {
    throw InvalidInput(what +
                       ": t: is zero; depth can be measured only if the projector stands "
                       "beside the camera");
  }
  check_chromatic(rig.red, what + ": chromatic.red");
  check_chromatic(rig.blue, what + ": chromatic.blue");
  check_mixing(rig.color_mixing, what + ": chromatic.mixing");
  if (rig.covariance) check_covariance(*rig.covariance, what);
}

Rig read_rig(const std::filesystem::path& path) {
  const StorageFile file(path);
  Rig rig;
  rig.camera = read_lens(file, "camera");
  rig.projector = read_lens(file, "projector");
  rig.T_projector_camera = read_pose(file);
  const YAML::Node chromatic = find_chromatic(file);
  rig.red = read_chromatic(file, chromatic, "red");
  rig.blue = read_chromatic(file, chromatic, "blue");
  rig.color_mixing = read_mixing(file, chromatic);
  rig.covariance = read_covariance(file);
  try {
    check_rig(rig, path.string());
  } catch (const InvalidInput& error) {
    throw FileError(error.what());
  }
  return rig;
}

void write_rig(const std::filesystem::path& path, const Rig& rig) {
  check_rig(rig, "write_rig(" + path.string() + ")");
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  write_lens(storage, "camera", rig.camera);
  write_lens(storage, "projector", rig.projector);
  cv::Mat R;
  cv::Mat t;
  const Eigen::Matrix3d linear = rig.T_projector_camera.linear();
  const Eigen::Vector3d translation = rig.T_projector_camera.translation();
  cv::eigen2cv(linear, R);
  cv::eigen2cv(translation, t);
  storage << "R" << R << "t" << t;
  storage << "chromatic"
          << "{";
  write_chromatic(storage, "red", rig.red);
  write_chromatic(storage, "blue", rig.blue);
  write_mixing(storage, rig.color_mixing);
  storage << "}";
  if (rig.covariance) {
    cv::Mat covariance;
    cv::eigen2cv(*rig.covariance, covariance);
    storage << "covariance" << covariance;
  }
  const std::string text = storage.releaseAndGetString();
  write_file(path, [&](std::ostream& out) { out << text; });
}

}  // namespace palpate::sensing
