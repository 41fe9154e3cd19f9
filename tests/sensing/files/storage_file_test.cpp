// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/storage_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

using cv::utils::logging::getLogLevel;

TEST(QuietOpenCv, LeavesTheLogLevelAsItWasWhateverTheOrderInWhichTheyGo) {
  const auto before = getLogLevel();
  ASSERT_NE(before, cv::utils::logging::LOG_LEVEL_SILENT);
  std::optional<QuietOpenCv> first, second;
  first.emplace();
  second.emplace();
  first.reset();
  EXPECT_EQ(getLogLevel(), cv::utils::logging::LOG_LEVEL_SILENT);
  second.reset();
  EXPECT_EQ(getLogLevel(), before);
}

TEST(QuietOpenCv, WorksInSeveralThreadsAtOnce) {
  const auto before = getLogLevel();
  std::array<std::thread, 4> threads;
  for (std::thread& thread : threads) {
    thread = std::thread([] {
      for (int round = 0; round < 1000; ++round) const QuietOpenCv quiet;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(getLogLevel(), before);
}

TEST(StorageFile, RefusesAKeyThatIsThereTwiceWithItsLine) {
  const ScratchFolder folder;
  const auto path = written(folder, "file.yaml", "%YAML:1.0\n---\na: 1\nb: 2\na: 3\n");
  const std::string message = message_of<FileError>([&] { const StorageFile file(path); });
  EXPECT_NE(message.find("file.yaml: line 5: a is there twice"), std::string::npos) << message;
}

TEST(StorageFile, RefusesASecondDocumentWithItsLine) {
  const ScratchFolder folder;
  // OpenCV's parser hangs at the second.
  for (const auto& [rest, line] : {std::pair("---\nb: 2\n", 4), std::pair("...\n- 3\n", 5)}) {
    const auto path = written(folder, "file.yaml", std::string("%YAML:1.0\n---\na: 1\n") + rest);
    const std::string message = message_of<FileError>([&] { const StorageFile file(path); });
    EXPECT_NE(message.find("file.yaml: line " + std::to_string(line) + ": the keys and values end"),
              std::string::npos)
        << message;
  }
}

TEST(StorageFile, NamesTheLineOfAnErrorInASecondDocument) {
  const ScratchFolder folder;
  const auto path = written(folder, "file.yaml", "%YAML:1.0\n---\na: 1\n---\nb: 2\nc: [ 1 }\n");
  const std::string message = message_of<FileError>([&] { const StorageFile file(path); });
  EXPECT_NE(message.find("file.yaml: line 6: not an OpenCV FileStorage file"), std::string::npos)
      << message;
}

// From some of these OpenCV's own parsers do not return, or they read beyond the text.
TEST(StorageFile, RefusesDamagedTexts) {
  const ScratchFolder folder;
  for (const char* text : {
           "%YAML:1.0\n---%YAML:1.0\n -  -\"\"\"\n",
           "%YAML:1.0\n---\na: 1\nb: 1 }\n- 2\n",
           "%YAML:1.0\n---\na: [ 1, 2\n",
           "%YAML:1.0\n---\n- 1\n",
           "%YAML:1.0\n---\na: 1\n]\n",
           "<?xml version=\"1.0\"?>\n<opencv_storage>\n<a>1</a\n",
           "solid mesh\n",
           "\x89PNG\r\n\"\\\x1b\x01",
       }) {
    const auto path = written(folder, "file.yaml", text);
    const std::string message = message_of<FileError>([&] { const StorageFile file(path); });
    EXPECT_NE(message.find("not an OpenCV FileStorage file"), std::string::npos) << text << message;
    EXPECT_TRUE(std::all_of(message.begin(), message.end(), [](unsigned char c) {
      return c >= ' ' && c <= '~';
    })) << message;
  }
}

TEST(StorageFile, ReadsWhatOpenCvWrites) {
  cv::FileStorage storage(".yaml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::Mat matrix = (cv::Mat_<float>(2, 3) << 1, -2.5, 3e-7, 4e9, 5, 0);
  // clang-format off
  storage << "whole" << -7 << "real" << 3.0 << "small" << 1.25e-12 << "word" << "R"
          << "quoted" << "a { b, c:d" << "digits" << "12" << "matrix" << matrix
          << "unknown" << std::nan("") << "maps" << "["
          << "{:" << "name" << "R" << "rgb" << "[:" << 255 << 0 << 1.5 << "]" << "}" << "]";
  // clang-format on
  const ScratchFolder folder;
  const StorageFile file(written(folder, "file.yaml", storage.releaseAndGetString()));
  const auto child = [&](const char* key) { return file.child(file.root(), key); };
  EXPECT_EQ(file.whole_number(child("whole"), "whole"), -7);
  EXPECT_EQ(file.number(child("real"), "real"), 3.0);
  EXPECT_EQ(file.number(child("small"), "small"), 1.25e-12);
  EXPECT_EQ(file.text(child("word"), "word"), "R");
  EXPECT_EQ(file.text(child("quoted"), "quoted"), "a { b, c:d");
  EXPECT_EQ(file.text(child("digits"), "digits"), "12");
  EXPECT_EQ(message_of<FileError>([&] {
              (void)file.number(child("unknown"), "unknown");
            }).substr((folder / "file.yaml").string().size()),
            ": unknown: is not finite");
  cv::Mat read;
  file.matrix("matrix").convertTo(read, matrix.type());
  EXPECT_EQ(cv::norm(read, matrix, cv::NORM_INF), 0);
  const auto maps = file.items(child("maps"), "maps");
  ASSERT_EQ(maps.size(), 1U);
  EXPECT_EQ(file.text(file.child(maps[0], "name"), "name"), "R");
  EXPECT_EQ(file.numbers(file.child(maps[0], "rgb"), "rgb"), (std::vector<double>{255, 0, 1.5}));
}

TEST(StorageFile, ReadsAPipe) {
  const ScratchFolder folder;
  const std::filesystem::path pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), S_IRUSR | S_IWUSR), 0);
  const std::string text = read_text(demo_path("rig.yaml"));
  std::jthread writer([&] { write_text(pipe, text); });
  const StorageFile file(pipe);
  EXPECT_EQ(file.matrix("camera_matrix").rows, 3);
}

TEST(StorageFile, RefusesWhatIsNoFile) {
  const ScratchFolder folder;
  const auto refusal = [](const std::filesystem::path& path) {
    return message_of<FileError>([&] { const StorageFile file(path); });
  };
  EXPECT_EQ(refusal(folder.path()), folder.path().string() + ": is a folder; expected a file");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is neither a file nor a pipe");
}

TEST(StorageFile, NamesTheKeyOfAValueOfAnotherKind) {
  const ScratchFolder folder;
  const StorageFile file(written(folder, "file.yaml",
                                 "%YAML:1.0\n---\nlist: [ 1, x ]\nword: \"12\"\nreal: 1.5\n"
                                 "huge: 99999999999\nnan: .Nan\nnothing:\n"));
  const auto refusal = [&](auto read) { return message_of<FileError>(read); };
  const auto child = [&](const char* key) { return file.child(file.root(), key); };
  const auto ends = [](const std::string& text, const std::string& end) {
    EXPECT_TRUE(text.ends_with(end)) << text;
  };
  ends(refusal([&] { (void)file.numbers(child("list"), "list"); }),
       "list[1]: a number is expected");
  ends(refusal([&] { (void)file.number(child("word"), "word"); }), "word: a number is expected");
  ends(refusal([&] { (void)file.text(child("real"), "real"); }), "real: a text is expected");
  ends(refusal([&] { (void)file.whole_number(child("real"), "real"); }),
       "a whole number is expected");
  ends(refusal([&] { (void)file.whole_number(child("huge"), "huge"); }),
       "a whole number is expected");
  ends(refusal([&] { (void)file.number(child("nan"), "nan"); }), "nan: is not finite");
  ends(refusal([&] { (void)file.items(child("nothing"), "nothing"); }),
       "nothing: a list is expected");
  ends(refusal([&] { (void)child("absent"); }), "absent: is missing");
}

TEST(StorageFile, RefusesAMatrixWithoutItsNumbersBeforeItTakesMemory) {
  const ScratchFolder folder;
  for (const char* keys : {
           "   rows: 100000\n   cols: 100000\n   dt: d\n   data: [ 1.0 ]\n",
           "   rows: many\n   cols: 1\n   dt: d\n   data: [ 1.0 ]\n",
           "   rows: 1\n   cols: 1\n   dt: d\n   data: 1.0\n",
           "   rows: 1\n   cols: 1\n   dt: d\n",
           "   rows: -1\n   cols: -1\n   dt: d\n   data: [ 1.0 ]\n",
       }) {
    write_text(folder / "file.yaml", std::string("%YAML:1.0\n---\nm: !!opencv-matrix\n") + keys);
    const StorageFile file(folder / "file.yaml");
    const std::string message = message_of<FileError>([&] { (void)file.matrix("m"); });
    EXPECT_NE(message.find("file.yaml: m: a matrix is expected"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace palpate::sensing
