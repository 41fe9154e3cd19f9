#!/usr/bin/env bash
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Submits a command to Slurm as an array of shards, and prints the ids of the jobs, joined by colons as --dependency takes them.
#   cluster/submit.sh SHARDS COMMAND...      cluster/submit.sh 100 palpate decode frames/ ... -o range/
# Set by the environment: PALPATE_TEMPLATE (slurm.sh beside this file), PALPATE_LOGS (the current folder), PALPATE_MEMORY (1G of
# a job), PALPATE_TIME (60 minutes of a job), PALPATE_ARRAY (1000: the largest array; Slurm's MaxArraySize is 1001), PALPATE_ONLY
# (all shards; or some, such as 3,17-20). The log of shard 1999 of 2000 is palpate-JOB-1000+999.log.
set -euo pipefail
if (($# < 2)); then
  sed -n 's/^#   //p' "$0" >&2
  exit 2
fi
shards=$1
shift
template=${PALPATE_TEMPLATE:-$(dirname "$0")/slurm.sh}
largest=${PALPATE_ARRAY:-1000}
mkdir -p "${PALPATE_LOGS:-.}"  # Slurm does not
only=${PALPATE_ONLY:-1-$shards}
jobs=()
for ((offset = 0; offset < shards; offset += largest)); do
  indices=
  for range in ${only//,/ }; do
    first=$((${range%-*} - offset)) last=$((${range#*-} - offset))
    ((first < 1)) && first=1
    ((last > largest)) && last=$largest
    ((first <= last)) && indices+=${indices:+,}$first-$last
  done
  [[ $indices ]] || continue
  command="$(printf '%q ' "$@")--shard \$((SLURM_ARRAY_TASK_ID + $offset))/$shards"
  job=$(<"$template")
  job=${job//'{command}'/"$command"}
  job=${job//'{log}'/"${PALPATE_LOGS:-.}/palpate-%A-$offset+%a.log"}
  job=${job//'{memory}'/"${PALPATE_MEMORY:-1G}"}
  job=${job//'{time}'/"${PALPATE_TIME:-60}"}
  if ! id=$(sbatch --parsable --array="$indices" <<<"$job"); then
    ((${#jobs[@]} == 0)) || scancel "${jobs[@]}"  # all or nothing
    exit 1
  fi
  jobs+=("$id")
done
(IFS=: && printf '%s\n' "${jobs[*]}")
