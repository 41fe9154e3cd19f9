// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document_node.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace palpate::documents {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

const std::string kText = "a:\n  b: [1, two]\nc: 0.50\nd:\n";

// What `read` refuses about a text in YAML.
template <typename Read>
std::string refused(const std::string& text, const Read& read) {
  const Document document = parse_yaml(text, "it.yaml");
  return refusal([&] {
    read(DocumentNode(document));
    return 0;
  });
}

TEST(DocumentNode, NamesLineAndPlaceOfAWrongValue) {
  EXPECT_EQ(
      refused(kText, [](const auto& root) { (void)root.at("a").at("b").items()[1].number(); }),
      "line 2, at /a/b/1: found \"two\", expected a number");
  EXPECT_EQ(refused(kText, [](const auto& root) { (void)root.at("c").number(above(1), "mm"); }),
            "line 3, at /c: found 0.5, expected a number > 1 [mm]");
  EXPECT_EQ(refused(kText, [](const auto& root) { (void)root.at("d").number(finite(), ""); }),
            "line 4, at /d: found null, expected a finite number");
  EXPECT_EQ(refused("[]", [](const auto& root) { (void)root.at("c"); }),
            "line 1, at the top: found [], expected an object");
  const Document json = parse_json(R"({"a": {"b~/": -1}})", "it.json");
  EXPECT_EQ(refusal([&] { return DocumentNode(json).at("a").at("b~/").number_at_least_zero(); }),
            "at /a/b~0~1: found -1, expected a number >= 0");
}

TEST(DocumentNode, RefusesNumbersBeyondTheirRange) {
  for (const char* const text : {"a: .nan", "a: 1e13", "a: -1e400", "a: .inf"}) {
    EXPECT_THAT(refused(text, [](const auto& root) { (void)root.at("a").number(); }),
                HasSubstr("line 1, at /a: found"))
        << text;
  }
  for (const char* const text : {"a: 2.5", "a: 4", "a: 99999999999", "a: '3'"}) {
    EXPECT_THAT(
        refused(text, [](const auto& root) { (void)root.at("a").integer(at_least(1).at_most(3)); }),
        EndsWith("expected a whole number in [1, 3]"))
        << text;
  }
}

TEST(DocumentNode, GivesWordsAsTheyAreWritten) {
  const Document yaml = parse_yaml("a: 0.50\nb: '7'\nc: yes\nd:\n", "it.yaml");
  const Document json = parse_json(R"({"a": 0.50, "b": "7", "c": true, "d": null})", "it.json");
  const auto word = [](const Document& document, const char* name) {
    return DocumentNode(document).at(name).word();
  };
  EXPECT_EQ(word(yaml, "a"), "0.50");
  EXPECT_EQ(word(yaml, "b"), "7");
  EXPECT_EQ(word(yaml, "c"), "yes");
  EXPECT_EQ(word(yaml, "d"), "");
  EXPECT_EQ(word(json, "a"), "0.5");
  EXPECT_EQ(word(json, "b"), "7");
  EXPECT_EQ(word(json, "c"), "true");
  EXPECT_EQ(word(json, "d"), "");
  EXPECT_THAT(refused(kText, [](const auto& root) { (void)root.at("a").word(); }),
              HasSubstr("at /a: found {\"b\":[1,\"two\"]}, expected one word or number"));
}

TEST(DocumentNode, GivesWhatACheckRefusesThePlaceAndTheNamesOfTheDocument) {
  EXPECT_EQ(refused(kText,
                    [](const auto& root) {
                      root.at("c").checked([] { require("Sheet::tension", -1, at_least(0)); });
                    }),
            "line 3, at /c: 'tension' is -1; it must be >= 0");
  const auto deeper = [](const auto& root) {
    root.at("c").checked([] { throw FileError("other.csv: line 9: is empty"); });
  };
  EXPECT_EQ(refused(kText, deeper), "other.csv: line 9: is empty");
}

TEST(DocumentMembers, RefuseWhatWasNotTaken) {
  EXPECT_EQ(refused("a: 1\nlength: 2\nwidht: 3\n",
                    [](const auto& root) {
                      DocumentMembers members(root);
                      double length = 0, width = 7;
                      members.take("length", length, above(0), "mm");
                      members.take("width", width, above(0), "mm");
                      EXPECT_EQ(length, 2);
                      EXPECT_EQ(width, 7);
                      (void)members.at("a");
                      members.end();
                    }),
            "line 3, at /widht: 'widht' is unknown; there are length, width, a");
  EXPECT_THAT(refused("a: 1\n", [](const auto& root) { (void)DocumentMembers(root).at("radius"); }),
              EndsWith("at the top: has no 'radius'"));
  EXPECT_THAT(refused("- 1\n", [](const auto& root) { DocumentMembers members(root); }),
              EndsWith("expected an object"));
}

TEST(InFile, NamesTheFileOnce) {
  EXPECT_EQ(refusal([] {
              return in_file("it.yaml", []() -> int { throw InvalidInput("at /a: is wrong"); });
            }),
            "it.yaml: at /a: is wrong");
  EXPECT_THAT(refusal([] {
                return in_file("it.yaml", []() -> int { throw FileError("path.csv: is empty"); });
              }),
              StartsWith("path.csv"));
}

}  // namespace
}  // namespace palpate::documents
