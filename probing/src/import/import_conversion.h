// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>

#include "palpate/probing/acquisition_mapping.h"

namespace palpate::probing {

/// From the units, signs and frame of the files to those of the surface.
class ImportConversion {
 public:
  explicit ImportConversion(const AcquisitionMapping& mapping)
      : mapping_(mapping), force_(mapping.forces_on_tool ? -mapping.force : mapping.force) {}

  [[nodiscard]] Eigen::Vector3d position(const Eigen::Vector3d& in_file) const {
    const Eigen::Vector3d p = mapping_.length * in_file;
    return mapping_.T_surface_file ? Eigen::Vector3d(*mapping_.T_surface_file * p) : p;
  }
  [[nodiscard]] Eigen::Vector3d direction(const Eigen::Vector3d& in_file) const {
    return mapping_.T_surface_file ? Eigen::Vector3d(mapping_.T_surface_file->linear() * in_file)
                                   : in_file;
  }
  /// The weight below the sensor pulls on it as a force of the object does, whatever the sign of
  /// its numbers.
  [[nodiscard]] Eigen::Vector3d force(const Eigen::Vector3d& in_file) const {
    return direction(force_ * in_file + mapping_.weight);
  }
  /// Of a number that is positive if the tool presses.
  [[nodiscard]] Eigen::Vector3d normal_force(double in_file, const Eigen::Vector3d& normal) const {
    return (direction(mapping_.weight).dot(normal) - force_ * in_file) * normal;
  }
  [[nodiscard]] double length(double in_file) const { return mapping_.length * in_file; }
  [[nodiscard]] double time(double in_file) const { return mapping_.time * in_file; }

 private:
  const AcquisitionMapping& mapping_;
  double force_;
};

}  // namespace palpate::probing
