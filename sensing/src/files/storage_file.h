// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace palpate::sensing {

/// The bytes of a file.
/// \throws FileError if it is missing, not a file, or empty.
[[nodiscard]] std::string read_bytes(const std::filesystem::path& path);

/// Prevents OpenCV from writing to the terminal while an object of this type exists in any thread.
/// OpenCV has one log level per process, which is restored with the last object.
class QuietOpenCv {
 public:
  QuietOpenCv();
  ~QuietOpenCv();
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;
};

/// An OpenCV FileStorage file for reading, with messages that name the file and the key. Every
/// function throws FileError if the value is missing or has another type.
class StorageFile {
 public:
  explicit StorageFile(std::filesystem::path path);

  [[nodiscard]] cv::FileNode root() const { return storage_.root(); }
  /// `place` precedes the key in messages.
  [[nodiscard]] cv::FileNode child(const cv::FileNode& parent, const std::string& key,
                                   const std::string& place = {}) const;
  [[nodiscard]] double number(const cv::FileNode& node, const std::string& key) const;  ///< finite
  [[nodiscard]] long whole_number(const cv::FileNode& node, const std::string& key) const;
  [[nodiscard]] std::string text(const cv::FileNode& node, const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const cv::FileNode& node, const std::string& key) const;
  /// A matrix of doubles or floats, finite.
  [[nodiscard]] cv::Mat_<double> matrix(const std::string& key) const;
  /// The items of a sequence.
  [[nodiscard]] std::vector<cv::FileNode> items(const cv::FileNode& node,
                                                const std::string& key) const;
  /// Throws a FileError with file, key, and what is wrong.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  std::filesystem::path path_;
  cv::FileStorage storage_;
};

}  // namespace palpate::sensing
