// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::documents {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Json read(const std::string& name, const std::string& text) {
  const ScratchFolder scratch;
  std::ofstream(scratch / name) << text;
  return read_document(scratch / name).value;
}

TEST(Document, ReadsTheSameFromYamlAndJson) {
  const std::string json =
      R"({"a": [1, 2.5, -3e-2], "b": {"c": true, "d": null, "e": "0.2 N"}, "f": "12", "g": {}, "h": []})";
  const std::string yaml =
      "a: [1, 2.5, -3e-2]\nb:\n  c: true\n  d: null\n  e: 0.2 N\nf: \"12\"\ng: {}\nh: []\n";
  EXPECT_EQ(read("it.yaml", yaml), read("it.json", json));
  EXPECT_EQ(read("it.yml", json), read("it.json", json));
  EXPECT_EQ(read("it.yaml", "a: !!str 12\n"), read("it.json", R"({"a": "12"})"));
}

TEST(Document, KeepsTheOrderOfMembers) {
  EXPECT_EQ(read("it.yaml", "b: 1\na: {d: 2, c: 3}\n").dump(), R"({"b":1,"a":{"d":2,"c":3}})");
  EXPECT_EQ(read("it.json", R"({"b": 1, "a": 2})").dump(), R"({"b":1,"a":2})");
}

TEST(Document, KnowsTheLinesAndTheWordsOfYaml) {
  const Document document = parse_yaml("a: 0.50\n\nb/c:\n  - x\n  -\n    d: ~\n", "it.yaml");
  EXPECT_EQ(document.places.at("/a").line, 1);
  EXPECT_EQ(document.places.at("/a").text, "0.50");
  EXPECT_EQ(document.places.at("/b~1c").line, 3);
  EXPECT_EQ(document.places.at("/b~1c/0").line, 4);
  EXPECT_EQ(document.places.at("/b~1c/1/d").line, 6);
  EXPECT_EQ(document.places.at("/b~1c/1/d").text, "");
}

TEST(Document, RefusesWhatIsNoDocument) {
  EXPECT_THAT(refusal([] { return read("it.json", "{"); }), HasSubstr("it.json: is not JSON"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\nb: [1, 2\n"); }),
              AllOf(HasSubstr("it.yaml: line 3: is not YAML (")));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\nb: 2\na: 3\n"); }),
              HasSubstr("it.yaml: line 3: 'a' is there twice, also in line 1; keep one"));
  EXPECT_THAT(refusal([] { return read("it.json", R"({"a": {"b": 1, "c": 2, "b": 3}})"); }),
              HasSubstr("it.json: 'b' is there twice"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: &x [1, *x]\n"); }),
              HasSubstr("is nested more than 32 levels deep"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\n[b]: 2\n"); }),
              HasSubstr("line 2: a name has parts; expected one word"));
  EXPECT_THAT(refusal([] { return read("it.yaml", "a: 1\n---\nb: 2\n"); }),
              HasSubstr("a second document begins"));
  EXPECT_THAT(refusal([] { return read_document("nowhere/it.yaml"); }), HasSubstr("no such file"));
}

TEST(Document, GivesYamlAsJsonAndJsonAsItIs) {
  const ScratchFolder scratch;
  const std::string text = "{\"a\":   1}\n";
  std::ofstream(scratch / "it.json") << text;
  std::ofstream(scratch / "it.yaml") << "a: 1\n";
  EXPECT_EQ(read_json_text(scratch / "it.json"), text);
  EXPECT_EQ(Json::parse(read_json_text(scratch / "it.yaml")), Json::parse(text));
}

}  // namespace
}  // namespace palpate::documents
