// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "palpate/sensing/decode_verdict.h"
#include "palpate/sensing/reason.h"
#include "seeing/decode_outputs.h"
#include "seeing/decode_record.h"
#include "shards/shard_journal.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// The result of one frame, for the report.
struct Outcome {
  std::string error;  ///< empty if there is a range map
  FinishedFrame frame;
  bool kept = false;  ///< from an earlier run
  double read_milliseconds = 0;
  double write_milliseconds = 0;
  std::vector<ShardFile> inputs = {}, outputs = {};  ///< with --shard
};
using Outcomes = std::map<std::size_t, Outcome>;  ///< by the number of the frame

/// "1234 reconstructed, 56 unlit, ..."
[[nodiscard]] std::string counts(const sensing::ReasonImage& reasons);

/// Judges all frames that were decoded as one sequence.
[[nodiscard]] sensing::DecodeJudgement judge_sequence(const Outcomes& outcomes);

/// Prints the results of the frames, and warns of those that do not fit rig, pattern and colours
/// although the sequence does.
/// \param output the folder with the range maps.
/// \param outputs the files that were written beside them.
/// \param seconds the total time.
void report_decoding(const Settings& settings, const std::filesystem::path& output,
                     const DecodeOutputs& outputs, const Outcomes& outcomes,
                     const sensing::DecodeJudgement& judgement, double seconds);

/// Refuses results of frames that do not fit rig, pattern or colours. Decoded frames stay in their
/// folder, but do not replace earlier results.
/// \param force if true, only warns.
/// \param remedy states the folder of the results, and how to accept them.
/// \throws Error with the likely cause, and the remedy.
void refuse_misfit(const sensing::DecodeJudgement& judgement, bool force,
                   const std::string& remedy);

/// The number of frames that could not be decoded.
/// \throws FileError if there is no other frame.
[[nodiscard]] std::size_t count_broken(const Outcomes& outcomes);

/// \throws Error if some frames could not be decoded.
void refuse_broken(std::size_t broken, std::size_t frames);

}  // namespace palpate::apps
