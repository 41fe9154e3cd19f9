// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/storage_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <sstream>
#include <utility>

#include "files/yaml_documents.h"
#include "palpate/error.h"

namespace palpate::sensing {
namespace {

cv::FileStorage open_storage(const std::filesystem::path& path) {
  const std::string bytes = read_bytes(path);
  // OpenCV's parser does not return from some files of several documents.
  if (const auto line = second_yaml_document(bytes)) {
    throw FileError(path.string() + ": line " + std::to_string(*line) +
                    ": the keys and values end here, but more follows; a closing bracket too many "
                    "or a second document (--- or ...)?");
  }
  const QuietOpenCv quiet;
  try {
    cv::FileStorage storage(bytes, cv::FileStorage::READ | cv::FileStorage::MEMORY);
    if (storage.isOpened() && storage.root().isMap()) return storage;
  } catch (const cv::Exception& error) {
    throw FileError(path.string() + ": not an OpenCV FileStorage file (" + error.err +
                    "); a YAML file that begins with %YAML:1.0 is expected");
  } catch (const std::exception&) {  // OpenCV's parser passes on those of std::string
    throw FileError(path.string() +
                    ": is damaged; a YAML file that begins with %YAML:1.0 is expected");
  }
  throw FileError(
      path.string() +
      ": not an OpenCV FileStorage file; a YAML file that begins with %YAML:1.0 and holds "
      "keys and values is expected");
}

/// The log level of OpenCV while any QuietOpenCv exists.
struct Silence {
  std::mutex mutex;
  int wanted_by = 0;
  cv::utils::logging::LogLevel before = cv::utils::logging::LOG_LEVEL_SILENT;
};

Silence& silence() {
  static Silence the_silence;
  return the_silence;
}

}  // namespace

QuietOpenCv::QuietOpenCv() {
  Silence& shared = silence();
  const std::lock_guard lock(shared.mutex);
  if (shared.wanted_by++ > 0) return;
  shared.before = cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
}

QuietOpenCv::~QuietOpenCv() {
  Silence& shared = silence();
  const std::lock_guard lock(shared.mutex);
  if (--shared.wanted_by == 0) cv::utils::logging::setLogLevel(shared.before);
}

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw FileError(path.string() + ": no such file");
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path.string() + ": not a file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size == 0) throw FileError(path.string() + ": the file is empty");
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  // Fails if the file cannot be opened or is truncated.
  if (!stream || !(bytes << stream.rdbuf())) throw FileError(path.string() + ": cannot be read");
  return std::move(bytes).str();
}

StorageFile::StorageFile(std::filesystem::path path)
    : path_(std::move(path)), storage_(open_storage(path_)) {}

void StorageFile::fail(const std::string& key, const std::string& message) const {
  throw FileError(path_.string() + ": " + key + ": " + message);
}

cv::FileNode StorageFile::child(const cv::FileNode& parent, const std::string& key,
                                const std::string& place) const {
  const cv::FileNode node = parent.isMap() ? parent[key] : cv::FileNode();
  if (node.empty()) fail(place + key, "is missing");
  return node;
}

double StorageFile::number(const cv::FileNode& node, const std::string& key) const {
  if (!node.isInt() && !node.isReal()) fail(key, "a number is expected");
  const double value = static_cast<double>(node);
  if (!std::isfinite(value)) fail(key, "is not finite");
  return value;
}

long StorageFile::whole_number(const cv::FileNode& node, const std::string& key) const {
  if (!node.isInt()) fail(key, "a whole number is expected");
  return static_cast<int>(node);
}

std::string StorageFile::text(const cv::FileNode& node, const std::string& key) const {
  if (!node.isString()) fail(key, "a text is expected");
  return static_cast<std::string>(node);
}

std::vector<cv::FileNode> StorageFile::items(const cv::FileNode& node,
                                             const std::string& key) const {
  if (!node.isSeq()) fail(key, "a list is expected");
  std::vector<cv::FileNode> result;
  for (const cv::FileNode& item : node) result.push_back(item);
  return result;
}

std::vector<double> StorageFile::numbers(const cv::FileNode& node, const std::string& key) const {
  std::vector<double> values;
  for (const cv::FileNode& item : items(node, key)) {
    values.push_back(number(item, key + "[" + std::to_string(values.size()) + "]"));
  }
  return values;
}

cv::Mat_<double> StorageFile::matrix(const std::string& key) const {
  const cv::FileNode node = child(root(), key);
  const auto count = [&](const char* entry) {
    const cv::FileNode value = node.isMap() ? node[entry] : cv::FileNode();
    return value.isInt() ? std::max(static_cast<int>(value), 0) : 0;
  };
  // OpenCV allocates rows x cols before it looks at the data.
  const double size = static_cast<double>(count("rows")) * count("cols");
  if (size == 0 || !node["data"].isSeq() || static_cast<double>(node["data"].size()) != size) {
    fail(key, "a matrix is expected: rows, cols, dt, and data with rows x cols numbers");
  }
  const QuietOpenCv quiet;
  cv::Mat matrix;
  try {
    node >> matrix;
  } catch (const cv::Exception& error) {
    fail(key, "not an OpenCV matrix (" + error.err + ")");
  }
  if (matrix.dims != 2 || matrix.channels() != 1) fail(key, "a matrix of one channel is expected");
  cv::Mat_<double> values = matrix;
  if (!cv::checkRange(values)) fail(key, "is not finite");
  return values;
}

}  // namespace palpate::sensing
