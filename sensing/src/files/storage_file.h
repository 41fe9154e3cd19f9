// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <yaml-cpp/yaml.h>
#include <filesystem>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <vector>

namespace palpate::sensing {

/// Prevents OpenCV from writing to the terminal while an object of this type exists in any thread.
/// OpenCV has one log level per process, which is restored with the last object.
class QuietOpenCv {
 public:
  QuietOpenCv();
  ~QuietOpenCv();
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;
};

/// A YAML file of OpenCV's FileStorage for reading, with messages that name the file and the key.
/// Every function throws FileError if the value is missing or has another type. yaml-cpp parses the
/// text, because OpenCV's parser does not return from some damaged files.
class StorageFile {
 public:
  explicit StorageFile(std::filesystem::path path);
  /// The same for the bytes of a file that has been read, which may be a pipe.
  StorageFile(std::filesystem::path path, const std::string& bytes);
  /// A YAML or JSON file of another program, of which only the first document counts: programs that
  /// print messages end each with a line of dashes.
  /// \param expected what is expected, for the message about a text that is neither.
  StorageFile(std::filesystem::path path, std::string bytes, const std::string& expected);

  [[nodiscard]] const YAML::Node& root() const { return root_; }  ///< a map
  /// Undefined if `parent` is not a map or does not hold the key.
  [[nodiscard]] static YAML::Node find(const YAML::Node& parent, const std::string& key);
  /// `place` precedes the key in messages.
  [[nodiscard]] YAML::Node child(const YAML::Node& parent, const std::string& key,
                                 const std::string& place = {}) const;
  [[nodiscard]] double number(const YAML::Node& node, const std::string& key) const;  ///< finite
  [[nodiscard]] int whole_number(const YAML::Node& node, const std::string& key) const;
  /// The text of a number, a word or a truth value, as it stands in the file.
  [[nodiscard]] std::string scalar(const YAML::Node& node, const std::string& key) const;
  [[nodiscard]] std::string text(const YAML::Node& node, const std::string& key) const;
  [[nodiscard]] std::vector<double> numbers(const YAML::Node& node, const std::string& key) const;
  /// A matrix of doubles or floats, finite.
  [[nodiscard]] cv::Mat_<double> matrix(const std::string& key) const;
  /// The items of a sequence.
  [[nodiscard]] std::vector<YAML::Node> items(const YAML::Node& node, const std::string& key) const;
  /// Throws if `map` holds another key: a misspelt one would count as one that was left out.
  void allow_only(const YAML::Node& map, const std::set<std::string>& keys,
                  const std::string& place = {}) const;
  /// Throws a FileError with file, key, and what is wrong.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  std::filesystem::path path_;
  YAML::Node root_;
};

}  // namespace palpate::sensing
