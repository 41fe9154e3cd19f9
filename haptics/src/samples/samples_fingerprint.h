// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::haptics {

/// Key of `Model::made` for the `probing::fingerprint` of the acquisition that a model is made of.
inline constexpr const char* kSamplesFingerprint = "samples_fingerprint";

}  // namespace palpate::haptics
