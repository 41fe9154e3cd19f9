/* SPDX-FileCopyrightText: Palpate contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Models of deformable objects, played back: the C interface of Palpate, for engines and other
 * languages. C99; library palpate_c.
 *
 * Lengths are in mm, forces in N, times in s, in the right-handed frame of the model. Vectors are
 * x, y, z. Memory is the caller's: functions fill what they are given and keep nothing.
 *
 * Functions that can fail return a status; palpate_error_text says why. Nothing is thrown. A failed
 * call changes nothing but *size of palpate_model_bytes. Missing pointers are PALPATE_INVALID.
 *
 * Each struct begins with struct_size, which the caller sets to sizeof of it: later versions add
 * members at the end, and read or write only what the caller's version has. */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#define PALPATE_API __attribute__((visibility("default")))

#ifdef __cplusplus
extern "C" {
#endif

/* Raised with each change that older callers cannot take. */
#define PALPATE_INTERFACE 1

typedef int32_t palpate_status;
#define PALPATE_OK 0
#define PALPATE_INVALID 1   /* an argument is wrong */
#define PALPATE_FILE 2      /* a file or folder is missing, damaged or of another version */
#define PALPATE_NO_MEMORY 3 /* there is not enough memory */
#define PALPATE_FAILED 4    /* anything else */

/* PALPATE_INTERFACE of the library that is loaded. Real-time safe. */
PALPATE_API int32_t palpate_interface(void);
/* Version of Palpate, such as "0.1.0". */
PALPATE_API const char* palpate_version(void);
/* The error of the latest call of this thread that failed, in words, until the next one that fails.
 * Never null. */
PALPATE_API const char* palpate_error_text(void);

/* A model: surface, force fields, friction. It never changes; all threads may use it. */
typedef struct palpate_model palpate_model;

/* Reads a model folder (surface.ply, field.json), or bytes of palpate_model_bytes of the same
 * version of Palpate. The bytes may be freed afterwards. */
PALPATE_API palpate_status palpate_model_open(const char* folder, palpate_model** model);
PALPATE_API palpate_status palpate_model_open_bytes(const void* bytes, uint64_t size,
                                                    palpate_model** model);
/* Null is allowed. Players of the model stay usable. */
PALPATE_API void palpate_model_close(palpate_model* model);

/* Gives the part of a model that playback needs as one block of bytes. Sets *size to their number;
 * if `bytes` is not null, writes them, or returns PALPATE_INVALID if *size was less than that. */
PALPATE_API palpate_status palpate_model_bytes(const palpate_model* model, void* bytes,
                                               uint64_t* size);

typedef struct palpate_model_facts {
  uint32_t struct_size;
  uint32_t vertices;         /* of the surface */
  uint32_t triangles;        /* of the surface */
  uint32_t contacts;         /* where the object was measured */
  uint32_t unknown_friction; /* contacts whose friction was not measured */
  uint32_t reserved;         /* 0 */
  double lower[3], upper[3]; /* [mm] corners of the box about the surface */
  double probe_radius;       /* [mm] of the ball that measured it; 0: not known */
  double shape_error;        /* [mm] of deformed surfaces, root mean square over recorded ones;
                                -1: none were recorded */
} palpate_model_facts;

PALPATE_API palpate_status palpate_model_describe(const palpate_model* model,
                                                  palpate_model_facts* facts);

/* The undeformed surface. `count` is the number of values that fit: at least 3 vertices, and 3
 * triangles. Triangles are counter-clockwise seen from outside. */
PALPATE_API palpate_status palpate_model_vertices(const palpate_model* model, float* xyz,
                                                  uint64_t count);
PALPATE_API palpate_status palpate_model_triangles(const palpate_model* model, int32_t* corners,
                                                   uint64_t count);

/* The force of a tool ON THE OBJECT [N] at a place of the surface (the nearest one is taken), for a
 * displacement of it [mm]. `deviation` may be null: the standard error of the force [N], NaN if the
 * model does not state it. Real-time safe. */
PALPATE_API palpate_status palpate_model_force(const palpate_model* model, const double place[3],
                                               const double displacement[3], double force[3],
                                               double* deviation);

/* A tool that touches a model. Many may touch one model; each is used by one thread at a time. */
typedef struct palpate_player palpate_player;

/* `options`: words NAME=VALUE of docs/options.md, PlaybackOptions, with blanks between them, such
 * as "unknown_friction=0.3 tolerance=1e-4"; others keep their defaults. Null: all do. */
PALPATE_API palpate_status palpate_player_create(const palpate_model* model, const char* options,
                                                 palpate_player** player);
/* Null is allowed. */
PALPATE_API void palpate_player_destroy(palpate_player* player);

#define PALPATE_FREE 0
#define PALPATE_STICK 1
#define PALPATE_SLIP 2

typedef struct palpate_tick {
  uint32_t struct_size;
  int32_t state;     /* PALPATE_FREE, PALPATE_STICK, PALPATE_SLIP */
  double force[3];   /* [N] ON THE USER */
  double contact[3]; /* [mm] on the undeformed surface; free: the tool */
} palpate_tick;

/* One tick of the haptic loop: the tool has moved to `tool` [mm] in `seconds`, such as 0.001. A
 * position that is not finite or jumps by more than 50 mm is not used; the force then decays within
 * 20 ticks. Real-time safe: it does not allocate, lock or print, and its time is bounded. */
PALPATE_API palpate_status palpate_player_step(palpate_player* player, const double tool[3],
                                               double seconds, palpate_tick* tick);
/* As if the tool had never touched. Real-time safe. */
PALPATE_API palpate_status palpate_player_reset(palpate_player* player);

#define PALPATE_SHAPE_BLENDED 0 /* follows recorded surfaces; the contact is at the tool */
#define PALPATE_SHAPE_NEAREST 1 /* is the recorded surface that is nearest; it jumps */

/* The surface as the tool deforms it in the latest tick. If surfaces were recorded for the model
 * (shape_error of palpate_model_facts), `rule` says how it is made of them; otherwise it is DRAWN,
 * NOT MEASURED: a smooth dent around the contact. `count` as for palpate_model_vertices. */
PALPATE_API palpate_status palpate_player_shape(const palpate_player* player, int32_t rule,
                                                float* xyz, uint64_t count);

/* A device that is called back: `read` waits for the next position of the tool [mm] in the frame of
 * the model, `write` gets the force [N] for the user. Both return 0, or anything else if the device
 * does not answer. They are called from the loop's thread and should neither allocate nor lock.
 * `read` sets the pace: it must wait for the period. */
typedef struct palpate_device_calls {
  uint32_t struct_size;
  uint32_t reserved; /* 0 */
  void* user;        /* passed on */
  int32_t (*read)(void* user, double tool[3]);
  int32_t (*write)(void* user, const double force[3]);
  double period;        /* [s] > 0 */
  double highest_force; /* [N] > 0; forces are limited to it, and to 3.3 N */
  double damping;       /* [N s/mm] of the device, for the virtual coupling; 0: a light grip's */
  double delay;         /* [s] >= 0, from a position to the force that answers it */
} palpate_device_calls;

/* A loop in a thread of its own, with the safety filter and the virtual coupling of Palpate between
 * model and device (docs/devices.md). */
typedef struct palpate_loop palpate_loop;

typedef struct palpate_loop_statistics {
  uint32_t struct_size;
  int32_t real_time;         /* 1: the thread has real-time priority */
  uint64_t ticks, late;      /* late: began more than half a period late */
  double rate;               /* [Hz] */
  double p50, p999, largest; /* [us] computing time of a tick: median, 99.9 %, largest */
  double largest_force;      /* [N] that was commanded */
  double given_energy;       /* [N mm] that the user was given in touches */
} palpate_loop_statistics;

/* `real_time` 1 asks for real-time priority. The callbacks must stay valid until the loop is
 * finished. */
PALPATE_API palpate_status palpate_loop_start(const palpate_model* model,
                                              const palpate_device_calls* device, int32_t real_time,
                                              palpate_loop** loop);
/* Ends the loop, waits for it, and frees it, whatever is returned; `statistics` may be null.
 * PALPATE_FAILED if the device had stopped answering. */
PALPATE_API palpate_status palpate_loop_finish(palpate_loop* loop,
                                               palpate_loop_statistics* statistics);

#ifdef __cplusplus
}
#endif

#endif
