/* SPDX-FileCopyrightText: Palpate contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * A program in C99: presses on a model folder and prints what it feels. */
#include <palpate.h>
#include <stdio.h>

static int fail(const char* what) {
  fprintf(stderr, "%s: %s\n", what, palpate_error_text());
  return 1;
}

int main(int count, char** words) {
  palpate_model* model = NULL;
  palpate_player* player = NULL;
  palpate_model_facts facts = {.struct_size = sizeof(facts)};
  palpate_tick tick = {.struct_size = sizeof(tick)};
  double largest = 0;
  int i;
  if (count != 2) {
    fprintf(stderr, "usage: %s MODEL\n", words[0]);
    return 2;
  }
  if (palpate_interface() != PALPATE_INTERFACE) return fail("another version of the library");
  if (palpate_model_open(words[1], &model) != PALPATE_OK) return fail("open");
  if (palpate_model_describe(model, &facts) != PALPATE_OK) return fail("describe");
  if (palpate_player_create(model, NULL, &player) != PALPATE_OK) return fail("create");
  palpate_model_close(model);
  for (i = 0; i < 2000; ++i) { /* along z through the middle, from 10 mm before to 10 mm behind */
    const double tool[3] = {(facts.lower[0] + facts.upper[0]) / 2,
                            (facts.lower[1] + facts.upper[1]) / 2,
                            (facts.lower[2] + facts.upper[2]) / 2 - 10 + 0.01 * i};
    if (palpate_player_step(player, tool, 1e-3, &tick) != PALPATE_OK) return fail("step");
    if (tick.force[2] * tick.force[2] > largest * largest) largest = tick.force[2];
  }
  palpate_player_destroy(player);
  printf("Palpate %s: %u contacts, %.3f N\n", palpate_version(), (unsigned)facts.contacts, largest);
  return 0;
}
