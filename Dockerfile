# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Palpate on systems other than Debian 12. This file has not been tested.
#   docker build -t palpate .
#   docker run --rm -v "$PWD:/data" -w /data palpate info scan.ply
FROM debian:12
COPY . /palpate
RUN /palpate/dev build && cmake --install /palpate/build/release --prefix /usr/local && ldconfig
ENTRYPOINT ["palpate"]
