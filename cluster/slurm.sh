#!/usr/bin/env bash
# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# The job of one shard on Slurm. Edit it for your site: partition, account, modules. One job holds one command.
# cluster/submit.sh replaces {command}, {log}, {memory} and {time}.
#SBATCH --job-name=palpate
#SBATCH --output="{log}"
#SBATCH --mem={memory}
#SBATCH --time={time}
#SBATCH --cpus-per-task=1
#SBATCH --requeue
exec {command} --threads "${SLURM_CPUS_PER_TASK:-1}"
