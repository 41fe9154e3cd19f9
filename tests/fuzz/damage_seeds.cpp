// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A short run of fuzz_readers.cpp without libFuzzer: feeds it with each file of a folder, which
// must be read, and with cut and damaged ones, which may be refused. The damages are the same in
// each run. Anything else that a reader does ends the program.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz_readers.h"

namespace {

namespace fs = std::filesystem;

constexpr int kCuts = 20;
constexpr int kDamages = 1000;
constexpr unsigned kMostSeconds = 20;             // for one file
constexpr rlim_t kMostMemory = rlim_t{4} << 30U;  // bytes

/// Texts that numbers are replaced by.
constexpr std::array<std::string_view, 8> kNumbers = {
    "-1", "0", "nan", "1e308", "-1e-308", "65536", "4294967296", "999999999999999999999"};

std::string feed(const std::string& bytes) {
  alarm(kMostSeconds);
  return refusal_of(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

class Damage {
 public:
  explicit Damage(std::string& bytes, unsigned seed) : bytes_(bytes), random_(seed) {}

  void apply() {
    switch (below(5)) {
      case 0:
        bytes_[place()] = static_cast<char>(below(256));
        break;
      case 1:
        bytes_[place()] = below(2) == 0 ? '\0' : '\xff';
        break;
      case 2:
        bytes_.erase(place(), 1 + below(16));
        break;
      case 3: {
        const std::string copy = bytes_.substr(place(), 1 + below(64));
        bytes_.insert(place(), copy);
        break;
      }
      default:
        replace_number();
    }
    if (bytes_.empty()) bytes_.push_back(' ');
  }

 private:
  std::size_t below(std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
  }
  std::size_t place() { return below(bytes_.size()); }
  void replace_number() {
    constexpr std::string_view kDigits = "0123456789.+-eE";
    const std::size_t first = bytes_.find_first_of("0123456789", place());
    if (first == std::string::npos) return;
    const std::size_t last = std::min(bytes_.find_first_not_of(kDigits, first), bytes_.size());
    bytes_.replace(first, last - first, kNumbers[below(kNumbers.size())]);
  }

  std::string& bytes_;
  std::mt19937 random_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || !fs::is_directory(argv[1])) {
    std::fprintf(stderr, "usage: PALPATE_READER=NAME damage_seeds FOLDER\n");
    return 2;
  }
#ifndef __SANITIZE_ADDRESS__  // which maps far more than it uses
  const rlimit memory{.rlim_cur = kMostMemory, .rlim_max = kMostMemory};
  setrlimit(RLIMIT_AS, &memory);
#endif
  std::vector<fs::path> seeds;
  for (const auto& entry : fs::directory_iterator(argv[1])) seeds.push_back(entry.path());
  std::sort(seeds.begin(), seeds.end());
  int fed = 0, read = 0;
  for (const fs::path& path : seeds) {
    std::ifstream file(path, std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(file), {}};
    if (const std::string refusal = feed(whole); !refusal.empty()) {
      std::fprintf(stderr, "%s must be read, but: %s\n", path.c_str(), refusal.c_str());
      return 1;
    }
    for (int i = 0; i < kCuts; ++i) read += feed(whole.substr(0, whole.size() * i / kCuts)).empty();
    for (unsigned i = 0; i < kDamages; ++i) {
      std::string bytes = whole;
      Damage damage(bytes, i);
      for (unsigned k = 0; k <= i % 3; ++k) damage.apply();
      read += feed(bytes).empty();
    }
    fed += kCuts + kDamages;
  }
  std::printf("%d damaged files: %d were read, the others refused\n", fed, read);
  return fed > 0 ? 0 : 1;
}
