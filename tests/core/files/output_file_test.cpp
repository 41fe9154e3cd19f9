// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/output_file.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdarg>
#include <filesystem>
#include <functional>
#include <future>
#include <iterator>
#include <ostream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "full_disk.h"
#include "palpate/core/error.h"
#include "throws_message.h"

namespace palpate {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMark = ".palpate-tmp-";
constexpr std::size_t kRoom = 10000;  // bytes on the disk that is full
const std::string kBig(10 * kRoom, 'x');

/// While it lives, the system calls below report to it their actions in `folder`.
class WatchedCalls {
 public:
  explicit WatchedCalls(fs::path folder) : folder_(std::move(folder)) { current = this; }
  ~WatchedCalls() { current = nullptr; }
  WatchedCalls(const WatchedCalls&) = delete;
  WatchedCalls& operator=(const WatchedCalls&) = delete;

  /// Called with the path of each temporary before it is created.
  std::function<void(const fs::path&)> before_creation = [](const fs::path&) {};
  /// "flush tmp.txt", "rename tmp.txt result.txt": names of temporaries without their marks.
  std::vector<std::string> events;

  void created(const fs::path& path) {
    if (path.string().find(kMark) != std::string::npos) before_creation(path);
  }
  void flushed(int file) {
    events.push_back("flush " + name(fs::read_symlink("/proc/self/fd/" + std::to_string(file))));
  }
  void renamed(const fs::path& from, const fs::path& to) {
    events.push_back("rename " + name(from) + " " + name(to));
  }

  /// As on a file system that cannot exchange two folders in one step.
  bool no_exchange = false;
  void exchanged(const fs::path& one, const fs::path& other) {
    events.push_back("exchange " + name(one) + " " + name(other));
  }

  static inline WatchedCalls* current = nullptr;

 private:
  [[nodiscard]] std::string name(const fs::path& path) const {
    std::string text = path.lexically_relative(folder_).string();
    for (const char* mark : {kMark, ".palpate-old-"}) {
      const std::size_t at = text.find(mark);
      if (at == std::string::npos) continue;
      const std::string kind = text.substr(at + 9, 3);  // "tmp" or "old"
      return text.replace(at, text.find_first_of("./", at + 1) - at, kind);
    }
    return text;
  }

  fs::path folder_;
};

auto text(const std::string& content) {
  return [content](std::ostream& stream) { stream << content; };
}

TEST(WriteFile, MakesTheFileAndItsFolders) {
  const ScratchFolder folder;
  write_file(folder / "a/b/result.txt", text("new\n"));
  EXPECT_EQ(read_text(folder / "a/b/result.txt"), "new\n");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFile, ShowsTheOldContentUntilTheNewOneIsWhole) {
  const ScratchFolder folder;
  write_text(folder / "result.txt", "old");
  write_file(folder / "result.txt", [&](std::ostream& stream) {
    stream << "half" << std::flush;
    EXPECT_EQ(read_text(folder / "result.txt"), "old");
    stream << " and half";
  });
  EXPECT_EQ(read_text(folder / "result.txt"), "half and half");
}

TEST(WriteFile, KeepsTheOldFileWhenTheWriterThrows) {
  const ScratchFolder folder;
  write_text(folder / "result.txt", "old");
  EXPECT_THROW(write_file(folder / "result.txt",
                          [](std::ostream& stream) {
                            stream << "half";
                            throw std::out_of_range("of the writer");
                          }),
               std::out_of_range);
  EXPECT_EQ(read_text(folder / "result.txt"), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFile, KeepsTheOldFileWhenTheDiskIsFull) {
  const ScratchFolder folder;
  write_text(folder / "result.txt", "old");
  {
    const FullDisk disk(kRoom);
    EXPECT_THROWS_MESSAGE(write_file(folder / "result.txt", text(kBig)), OutputError, "unchanged");
  }
  EXPECT_EQ(read_text(folder / "result.txt"), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFile, SeesAFullDiskEvenIfOnlyTheLastBufferFindsNoRoom) {
  const ScratchFolder folder;
  const FullDisk disk(10);  // less than the stream buffers: nothing fails before the flush
  EXPECT_THROWS_MESSAGE(write_file(folder / "result.txt", text("eleven bytes")), OutputError,
                        "result.txt");
  EXPECT_EQ(folder.entries(), 0);
}

TEST(WriteFile, StopsTheWriterAtTheFirstByteThatFindsNoRoom) {
  const ScratchFolder folder;
  const FullDisk disk(kRoom);
  int calls = 0;
  EXPECT_THROW(write_file(folder / "result.txt",
                          [&](std::ostream& stream) {
                            for (; calls < 100; ++calls) stream << kBig;
                          }),
               OutputError);
  EXPECT_LT(calls, 2);
}

TEST(WriteFile, WritesThroughSymbolicLinks) {
  const ScratchFolder folder;
  fs::create_directory(folder / "elsewhere");
  fs::create_symlink("elsewhere/result.txt", folder / "second");
  fs::create_symlink("second", folder / "first");
  for (const std::string content : {"made", "replaced"}) {
    write_file(folder / "first", text(content));
    EXPECT_TRUE(fs::is_symlink(folder / "first"));
    EXPECT_TRUE(fs::is_symlink(folder / "second"));
    EXPECT_EQ(read_text(folder / "elsewhere/result.txt"), content);
  }
}

TEST(WriteFile, RefusesACircleOfLinks) {
  const ScratchFolder folder;
  fs::create_symlink("b", folder / "a");
  fs::create_symlink("a", folder / "b");
  EXPECT_THROWS_MESSAGE(write_file(folder / "a", text("")), OutputError, "circle");
}

TEST(WriteFile, KeepsThePermissionsOfTheFileItReplaces) {
  const ScratchFolder folder;
  write_text(folder / "result.txt", "old");
  fs::permissions(folder / "result.txt", fs::perms{0640});
  write_file(folder / "result.txt", text("new"));
  EXPECT_EQ(fs::status(folder / "result.txt").permissions(), fs::perms{0640});
}

TEST(WriteFile, RefusesAFolderADeviceAndAFileAsParent) {
  const ScratchFolder folder;
  write_text(folder / "file", "old");
  EXPECT_THROWS_MESSAGE(write_file(folder.path(), text("")), InvalidInput, "name of a file");
  EXPECT_THROWS_MESSAGE(write_file("/dev/null", text("")), InvalidInput, "regular file");
  EXPECT_THROWS_MESSAGE(write_file(folder / "file/result.txt", text("")), OutputError,
                        "file/result.txt");
  EXPECT_EQ(read_text(folder / "file"), "old");
}

TEST(WriteFile, GivesEachThreadATemporaryOfItsOwn) {
  const ScratchFolder folder;
  std::vector<std::thread> threads;
  for (char letter = 'a'; letter < 'i'; ++letter)
    threads.emplace_back([&folder, letter] {
      for (int repeat = 0; repeat < 20; ++repeat)
        write_file(folder / "result.txt", text(std::string(kRoom, letter)));
    });
  for (std::thread& thread : threads) thread.join();
  const std::string content = read_text(folder / "result.txt");
  EXPECT_EQ(content, std::string(kRoom, content.front()));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFileByPath, KeepsTheExtensionAndRemovesWhatTheWriterLeft) {
  const ScratchFolder folder;
  write_file_by_path(folder / "result.ply", [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.extension(), ".ply");
    EXPECT_EQ(temporary.parent_path(), folder.path());
    write_text(temporary, "new");
  });
  EXPECT_EQ(read_text(folder / "result.ply"), "new");
  EXPECT_THROW(write_file_by_path(folder / "result.ply",
                                  [](const fs::path& temporary) {
                                    write_text(temporary, "half");
                                    throw OutputError("of the library");
                                  }),
               OutputError);
  EXPECT_EQ(read_text(folder / "result.ply"), "new");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFileByPath, ReportsAWriterThatWroteNothing) {
  const ScratchFolder folder;
  EXPECT_THROWS_MESSAGE(write_file_by_path(folder / "result.ply", [](const fs::path&) {}),
                        OutputError, "nothing was written");
  EXPECT_EQ(folder.entries(), 0);
}

// Another host can come to the same name until the file exists.
TEST(WriteFileByPath, ReservesTheTemporaryBeforeTheWriterOpensIt) {
  const ScratchFolder folder;
  write_file_by_path(folder / "result.ply", [](const fs::path& temporary) {
    EXPECT_TRUE(fs::is_empty(temporary));
    write_text(temporary, "new");
  });
}

TEST(WriteFile, NeverOverwritesATemporaryOfAnotherHost) {
  const ScratchFolder folder;
  fs::path taken;
  {
    WatchedCalls calls(folder.path());
    calls.before_creation = [&](const fs::path& temporary) {
      if (!taken.empty()) return;
      taken = temporary;
      write_text(temporary, "of another host");
    };
    write_file(folder / "result.txt", text("new"));
  }
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(read_text(taken), "of another host");
  EXPECT_EQ(read_text(folder / "result.txt"), "new");
  EXPECT_EQ(folder.entries(), 2);
}

TEST(WriteFile, FlushesTheFileBeforeTheRenameAndTheFolderAfterIt) {
  const ScratchFolder folder;
  fs::create_directory(folder / "a");
  WatchedCalls calls(folder.path());
  write_file(folder / "a/result.txt", text("new"));
  EXPECT_EQ(calls.events, (std::vector<std::string>{"flush a/tmp.txt",
                                                    "rename a/tmp.txt a/result.txt", "flush a"}));
}

const std::vector<fs::path> kEntries = {"field.json", "old"};

TEST(WriteFolder, MakesReplacesAndRemovesOldFiles) {
  const ScratchFolder folder;
  write_folder(folder / "model/", kEntries, [](const fs::path& temporary) {
    write_text(temporary / "field.json", "1");
    write_text(temporary / "old", "1");
  });
  write_folder(folder / "model", kEntries,
               [](const fs::path& temporary) { write_text(temporary / "field.json", "2"); });
  EXPECT_EQ(read_text(folder / "model/field.json"), "2");
  EXPECT_FALSE(fs::exists(folder / "model/old"));
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFolder, NeverUsesATemporaryOfAnotherHost) {
  const ScratchFolder folder;
  fs::path taken;
  {
    WatchedCalls calls(folder.path());
    calls.before_creation = [&](const fs::path& temporary) {
      if (!taken.empty()) return;
      taken = temporary;
      fs::create_directory(taken);
      write_text(taken / "field.json", "of another host");
    };
    write_folder(folder / "model", kEntries,
                 [](const fs::path& temporary) { write_text(temporary / "field.json", "new"); });
  }
  ASSERT_FALSE(taken.empty());
  EXPECT_EQ(read_text(taken / "field.json"), "of another host");
  EXPECT_EQ(read_text(folder / "model/field.json"), "new");
}

TEST(WriteFolder, FlushesAllItHoldsBeforeTheRenameAndItsParentAfterIt) {
  const ScratchFolder folder;
  WatchedCalls calls(folder.path());
  write_folder(folder / "model", kEntries, [](const fs::path& temporary) {
    fs::create_directory(temporary / "old");
    write_text(temporary / "old/1.ply", "1");
  });
  EXPECT_EQ(calls.events, (std::vector<std::string>{"flush tmp/old", "flush tmp/old/1.ply",
                                                    "flush tmp", "rename tmp model", "flush ."}));
}

// So there is no moment at which a process can be killed and the folder is not there.
TEST(WriteFolder, TakesThePlaceOfAnotherFolderInOneStep) {
  const ScratchFolder folder;
  fs::create_directory(folder / "model");
  write_text(folder / "model/field.json", "old");
  WatchedCalls calls(folder.path());
  write_folder(folder / "model", kEntries,
               [](const fs::path& temporary) { write_text(temporary / "field.json", "new"); });
  EXPECT_EQ(calls.events, (std::vector<std::string>{"flush tmp/field.json", "flush tmp",
                                                    "exchange tmp model", "flush ."}));
  EXPECT_EQ(read_text(folder / "model/field.json"), "new");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFolder, KeepsTheOldFolderUnderANameThatNobodyRemovesIfTwoCannotBeExchanged) {
  const ScratchFolder folder;
  fs::create_directory(folder / "model");
  write_text(folder / "model/field.json", "old");
  WatchedCalls calls(folder.path());
  calls.no_exchange = true;
  write_folder(folder / "model", kEntries,
               [](const fs::path& temporary) { write_text(temporary / "field.json", "new"); });
  EXPECT_EQ(calls.events,
            (std::vector<std::string>{"flush tmp/field.json", "flush tmp", "rename model old",
                                      "rename tmp model", "flush ."}));
  EXPECT_EQ(read_text(folder / "model/field.json"), "new");
  EXPECT_EQ(folder.entries(), 1);
}

/// In a process that is killed meanwhile.
void die_while_writing(const std::function<void()>& write) {
  const pid_t child = ::fork();
  if (child == 0) {
    write();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status));
}

TEST(RemoveLeftOvers, RemovesOfAFolderOnlyTheTemporariesOfKilledProcesses) {
  const ScratchFolder folder;
  fs::create_directory(folder / "out");
  write_text(folder / "out/.palpate-tmp-elsewhere-1-0-a.txt", "of another host");
  die_while_writing([&] {
    write_folder(folder / "out/model", kEntries, [&](const fs::path& temporary) {
      write_text(temporary / "field.json", "half");
      write_file(folder / "out/result.txt", [](std::ostream&) { ::raise(SIGKILL); });
    });
  });
  const auto count = [&] {
    return std::distance(fs::directory_iterator(folder / "out"), fs::directory_iterator());
  };
  ASSERT_EQ(count(), 3);
  // A living writer of the same process, and one of another, which is asked to look as well.
  write_file(folder / "out/one.txt", [&](std::ostream& one) {
    one << "one";
    const pid_t other = ::fork();
    if (other == 0) {
      write_file(folder / "out/two.txt", text("two"));
      ::_exit(0);
    }
    ::waitpid(other, nullptr, 0);
  });
  EXPECT_EQ(read_text(folder / "out/one.txt"), "one");
  EXPECT_EQ(read_text(folder / "out/two.txt"), "two");
  EXPECT_TRUE(fs::exists(folder / "out/.palpate-tmp-elsewhere-1-0-a.txt"));
  EXPECT_EQ(count(), 3);
}

TEST(RemoveLeftOvers, OfAKilledProcessDoNotKeepAFolderFromBeingReplaced) {
  const ScratchFolder folder;
  fs::create_directory(folder / "model");
  die_while_writing(
      [&] { write_file(folder / "model/old", [](std::ostream&) { ::raise(SIGKILL); }); });
  EXPECT_NO_THROW(check_replaceable(folder / "model", kEntries));
  EXPECT_TRUE(fs::is_empty(folder / "model"));
}

TEST(AbandonTemporaries, RemovesWhatOtherThreadsAreWriting) {
  const ScratchFolder folder;
  write_text(folder / "result.txt", "old");
  const pid_t child = ::fork();
  if (child == 0) {
    std::promise<void> begun;
    std::thread([&] {
      write_folder(folder / "model", kEntries, [&](const fs::path& temporary) {
        write_text(temporary / "field.json", "half");
        write_file(folder / "result.txt", [&](std::ostream& stream) {
          stream << "half" << std::flush;
          begun.set_value();
          std::this_thread::sleep_for(std::chrono::hours(1));
        });
      });
    }).detach();
    begun.get_future().wait();
    abandon_temporaries();
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(read_text(folder / "result.txt"), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFolder, KeepsTheOldFolderWhenTheWriterThrows) {
  const ScratchFolder folder;
  fs::create_directory(folder / "model");
  write_text(folder / "model/field.json", "old");
  EXPECT_THROW(write_folder(folder / "model", kEntries,
                            [](const fs::path& temporary) {
                              write_text(temporary / "field.json", "half");
                              throw OutputError("disk full");
                            }),
               OutputError);
  EXPECT_EQ(read_text(folder / "model/field.json"), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(WriteFolder, ReplacesAnEmptyFolderBehindALink) {
  const ScratchFolder folder;
  fs::create_directory(folder / "empty");
  fs::create_symlink("empty", folder / "link");
  write_folder(folder / "link", kEntries,
               [](const fs::path& temporary) { write_text(temporary / "field.json", "new"); });
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(read_text(folder / "empty/field.json"), "new");
}

TEST(WriteFolder, NamesTheFolderThatTheUserKnowsWhenTheDiskIsFull) {
  const ScratchFolder folder;
  const fs::path model = folder / "model";
  EXPECT_THROWS_MESSAGE(write_folder(model, kEntries,
                                     [](const fs::path& temporary) {
                                       write_file(temporary / "field.json", [](std::ostream& out) {
                                         out.setstate(std::ios::badbit);
                                       });
                                     }),
                        OutputError, (model / "field.json").string());
}

TEST(WriteFolder, NeverRemovesWhatSomebodyElsePutThere) {
  const ScratchFolder folder;
  fs::create_directory(folder / "model");
  write_text(folder / "model/field.json", "old");
  write_text(folder / "model/measurements.db", "precious");
  const auto fail = [](const fs::path&) { FAIL() << "the writer was called"; };
  EXPECT_THROWS_MESSAGE(write_folder(folder / "model", kEntries, fail), InvalidInput,
                        "measurements.db");
  EXPECT_THROWS_MESSAGE(check_replaceable(folder / "model", kEntries), InvalidInput,
                        "measurements.db");
  EXPECT_EQ(read_text(folder / "model/measurements.db"), "precious");
}

TEST(WriteFolder, RefusesAFolderOfAnotherKindBeforeItWritesAnything) {
  const ScratchFolder folder;
  write_text(folder / "precious", "old");
  const auto fail = [](const fs::path&) { FAIL() << "the writer was called"; };
  EXPECT_THROWS_MESSAGE(write_folder(folder.path(), kEntries, fail), InvalidInput,
                        "new or an empty folder");
  EXPECT_THROWS_MESSAGE(write_folder(folder / "precious", kEntries, fail), InvalidInput,
                        "is a file");
  EXPECT_EQ(read_text(folder / "precious"), "old");
}

}  // namespace
}  // namespace palpate

// The calls of the library come here first, because the program is searched before the system's
// libraries.
namespace {

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

palpate::WatchedCalls* watch() { return palpate::WatchedCalls::current; }

}  // namespace

extern "C" {

int fsync(int file) {
  if (watch() != nullptr) watch()->flushed(file);
  return next<int(int)>("fsync")(file);
}

int rename(const char* from, const char* to) noexcept {
  if (watch() != nullptr) watch()->renamed(from, to);
  return next<int(const char*, const char*)>("rename")(from, to);
}

int renameat2(int from_folder, const char* from, int to_folder, const char* to,
              unsigned flags) noexcept {
  if (watch() != nullptr && watch()->no_exchange) {
    errno = EINVAL;
    return -1;
  }
  if (watch() != nullptr) watch()->exchanged(from, to);
  return next<int(int, const char*, int, const char*, unsigned)>("renameat2")(from_folder, from,
                                                                              to_folder, to, flags);
}

int mkdir(const char* path, mode_t mode) noexcept {
  if (watch() != nullptr) watch()->created(path);
  return next<int(const char*, mode_t)>("mkdir")(path, mode);
}

int open(const char* path, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & O_CREAT) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (watch() != nullptr && (flags & O_EXCL) != 0) watch()->created(path);
  return next<int(const char*, int, ...)>("open")(path, flags, mode);
}

}  // extern "C"
