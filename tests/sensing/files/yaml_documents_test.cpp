// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/yaml_documents.h"

#include <gtest/gtest.h>

#include <string>

namespace palpate::sensing {
namespace {

TEST(SecondYamlDocument, IsNotSeenInASingleDocument) {
  for (const char* text : {
           "",
           "%YAML:1.0\n---\na: 1\n",
           "%YAML 1.0\n# two colours\n---\na: [ 1,\n  -2 ]\nb: { c: [ 3 ] }\n...\n",
           "%YAML:1.0\na: 1\r\n...\r\n\r\n# the end\r\n",
           "%YAML:1.0\n---\ntext: \"a ] \\\" } b\"  # of } two\nother: '}'\nrest: it's { } all\n",
           "{ \"json\": 1 } }\n---\n",
       }) {
    EXPECT_FALSE(second_yaml_document(text)) << text;
  }
}

TEST(SecondYamlDocument, IsSeenAtItsLine) {
  EXPECT_EQ(second_yaml_document("%YAML:1.0\n---\na: 1\n---\nb: 2\n"), 4);
  EXPECT_EQ(second_yaml_document("%YAML:1.0\n---\na: 1\n...\n\n- 3\n"), 6);
  EXPECT_EQ(second_yaml_document("%YAML:1.0\na: 1\n---\n"), 3);
}

TEST(SecondYamlDocument, IsSeenWhereABracketClosesMoreThanWasOpened) {
  EXPECT_EQ(second_yaml_document("%YAML:1.0\n---\n[ 1 ] }\n- 2\n"), 3);
  EXPECT_EQ(second_yaml_document("%YAML:1.0\n---\na: [ 1,\n  2 ]\nb: ] [\n"), 5);
}

}  // namespace
}  // namespace palpate::sensing
