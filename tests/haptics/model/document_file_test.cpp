// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

nlohmann::json read(const std::string& name, const std::string& text) {
  const ScratchFolder scratch;
  std::ofstream(scratch / name) << text;
  return read_document_file(scratch / name);
}

TEST(DocumentFile, ReadsTheSameFromYamlAndJson) {
  const std::string json =
      R"({"a": [1, 2.5, -3e-2], "b": {"c": true, "d": null, "e": "0.2 N"}, "f": "12", "g": {}, "h": []})";
  const std::string yaml =
      "a: [1, 2.5, -3e-2]\nb:\n  c: true\n  d: null\n  e: 0.2 N\nf: \"12\"\ng: {}\nh: []\n";
  EXPECT_EQ(read("it.yaml", yaml), read("it.json", json));
  EXPECT_EQ(read("it.yml", json), read("it.json", json));
  EXPECT_EQ(read("it.yaml", "a: !!str 12\n"), read("it.json", R"({"a": "12"})"));
}

TEST(DocumentFile, RefusesWhatIsNoDocument) {
  EXPECT_THAT(refusal([] { return read("it.json", "{"); }), HasSubstr("it.json: is not JSON"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\nb: [1, 2\n"); }),
              AllOf(HasSubstr("it.yaml:"), HasSubstr("is not YAML")));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\nb: 2\na: 3\n"); }),
              HasSubstr("it.yaml:3: 'a' is there twice"));
  EXPECT_THAT(refusal([] { return read("it.json", R"({"a": {"b": 1, "c": 2, "b": 3}})"); }),
              HasSubstr("it.json: 'b' is there twice"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: &x [1, *x]\n"); }),
              HasSubstr("is nested more than 32 levels deep"));
  EXPECT_THAT(refusal([] { return read_document_file("nowhere/it.yaml"); }),
              HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace palpate::haptics
