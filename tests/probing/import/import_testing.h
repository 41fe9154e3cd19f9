// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "palpate/probing/acquisition_import.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::probing {

/// Files that are imported.
class ImportTest : public ::testing::Test {
 protected:
  CheckedAcquisition import(const std::vector<std::string>& names,
                            const AcquisitionMapping& mapping) const {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : names) files.push_back(folder / name);
    return import_acquisition(files, mapping).acquisition;
  }
  std::string refused(const std::vector<std::string>& names,
                      const AcquisitionMapping& mapping) const {
    return refusal([&] { return import(names, mapping); });
  }

  ScratchFolder folder;
};

}  // namespace palpate::probing
