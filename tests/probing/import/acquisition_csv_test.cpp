// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/acquisition_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "records/probing_testing.h"
#include "repository.h"

namespace palpate::probing {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::filesystem::path kSheet = repository("demo") / "sheet";

TEST(AcquisitionCsv, ReadsBackExactlyWhatWasWritten) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  expect_same(read_acquisition_csv(folder / "c.csv", folder / "s.csv"), small_acquisition());
}

TEST(AcquisitionCsv, ReadsTheBundledSheet) {
  const CheckedAcquisition sheet =
      read_acquisition_csv(kSheet / "contacts.csv", kSheet / "samples.csv");
  EXPECT_EQ(sheet.contacts().size(), 46u);
  EXPECT_EQ(sheet.samples().size(), 11638u);
  EXPECT_EQ(sheet.samples()[1].b, Eigen::Vector3d(-37.5019, -58.0806, 701.03));
  EXPECT_TRUE(sheet.samples()[1].slipped);
}

TEST(AcquisitionCsv, NamesTheFileAndTheRecordThatIsWrong) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  std::string text = read_text(folder / "s.csv");
  text.replace(text.find("\n2,3,"), 5, "\n2,9,");
  write_text(folder / "s.csv", text);
  EXPECT_THAT(refusal([&] { return read_acquisition_csv(folder / "c.csv", folder / "s.csv"); }),
              AllOf(HasSubstr("s.csv"), HasSubstr("sample 2"), HasSubstr("no contact 9")));
  EXPECT_THAT(refusal([&] { return read_acquisition_csv(folder / "s.csv", folder / "s.csv"); }),
              AllOf(HasSubstr("s.csv: line 1"), HasSubstr("no column 'x'")));
}

TEST(AcquisitionCsv, RefusesEveryFileThatIsCutInsideALine) {
  const ScratchFolder folder;
  write_acquisition_csv(small_acquisition(), folder / "c.csv", folder / "s.csv");
  const std::string text = read_text(folder / "s.csv");
  const std::size_t last_line = text.rfind('\n', text.size() - 2);
  for (std::size_t length = last_line + 2; length < text.rfind(','); ++length) {
    write_text(folder / "s.csv", text.substr(0, length));
    EXPECT_THROW(static_cast<void>(read_acquisition_csv(folder / "c.csv", folder / "s.csv")),
                 FileError)
        << length;
  }
}

TEST(AcquisitionCsv, WritesNothingIfTheAcquisitionIsWrong) {
  const ScratchFolder folder;
  write_text(folder / "c.csv", "old");
  Acquisition acquisition = small_acquisition();
  acquisition.samples[0].range_map = "two\nlines";
  EXPECT_THROW(write_acquisition_csv(acquisition, folder / "c.csv", folder / "s.csv"),
               InvalidInput);
  EXPECT_EQ(read_text(folder / "c.csv"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "s.csv"));
}

}  // namespace
}  // namespace palpate::probing
