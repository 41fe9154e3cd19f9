#!/bin/sh
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Makes the shards of a command with GNU parallel, on this machine or on those that PARALLEL_HOSTS lists (--sshlogin).
#   cluster/parallel.sh SHARDS COMMAND...      cluster/parallel.sh 100 palpate decode frames/ ... -o range/
# shards.log, in the current folder, says which shards failed. Run the same call again: finished shards end at once.
if [ $# -lt 2 ]; then
  sed -n 's/^#   //p' "$0" >&2
  exit 2
fi
shards=$1
shift
exec parallel --quote --joblog shards.log ${PARALLEL_HOSTS:+--sshlogin "$PARALLEL_HOSTS" --workdir .} \
  "$@" --threads 1 --shard "{}/$shards" ::: $(seq "$shards")
