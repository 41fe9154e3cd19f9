// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/pixel_format.h"

#include <gtest/gtest.h>

namespace palpate::sensing {
namespace {

TEST(PixelFormat, TheLettersOfAMosaicAreItsFirstTwoPixels) {
  EXPECT_EQ(pixel_format("BayerRG8")->bayer, BayerPattern::rggb);
  EXPECT_EQ(pixel_format("BayerGR12")->bayer, BayerPattern::grbg);
  EXPECT_EQ(pixel_format("BayerGB10")->bayer, BayerPattern::gbrg);
  EXPECT_EQ(pixel_format("BayerBG16")->bayer, BayerPattern::bggr);
  EXPECT_EQ(pixel_format("BayerGR12")->bits, 12);
}

TEST(PixelFormat, ColourIsRedOrBlueFirst) {
  EXPECT_TRUE(pixel_format("RGB8")->red_first);
  EXPECT_TRUE(pixel_format("RGB8Packed")->red_first);
  EXPECT_FALSE(pixel_format("BGR8")->red_first);
  EXPECT_EQ(pixel_format("BGR8")->channels, 3);
  EXPECT_EQ(pixel_format("Mono16")->bits, 16);
}

TEST(PixelFormat, PackedPixelsAndLettersAfterANumberAreNotRead) {
  for (const char* name : {"Mono12Packed", "BayerRG12p", "YUV422_8", "Mono", "mono8", "", "Mono9"})
    EXPECT_FALSE(pixel_format(name)) << name;
}

}  // namespace
}  // namespace palpate::sensing
