/* SPDX-FileCopyrightText: Palpate contributors
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PALPATE_DEVICE_PLUGIN_H
#define PALPATE_DEVICE_PLUGIN_H

/* The interface between Palpate and the driver of a force-feedback device: a table of C functions
 * in a shared library. Probing and playback use the same table; nothing here depends on what the
 * device is used for. docs/devices.md says how to write a driver.
 *
 * A driver includes this header alone, fills one palpate_device_v1 and exports
 *
 *     const palpate_device_v1* palpate_device(void);
 *
 * Vectors are in the frame of the device's base, x, y, z; millimetre, newton, second, radian. What
 * a device does not measure it leaves as it is: NaN. Every function but close and last_error
 * returns 0, or anything else after a failure that last_error then describes.
 *
 * One thread at a time calls. read, write and stop are called at the rate of the device and must
 * not allocate, lock or print. */

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define PALPATE_DEVICE_VERSION 1u
#define PALPATE_DEVICE_SYMBOL "palpate_device"
#define PALPATE_DEVICE_JOINTS 8

/* What a device can do: bits of palpate_device_info_v1.capabilities. */
#define PALPATE_DEVICE_MEASURES_JOINTS 1u
#define PALPATE_DEVICE_MEASURES_FORCE 2u
#define PALPATE_DEVICE_MEASURES_HEAT 4u
#define PALPATE_DEVICE_MEASURES_REFERENCE 8u
#define PALPATE_DEVICE_MEASURES_VELOCITY 16u
#define PALPATE_DEVICE_MEASURES_ORIENTATION 32u
#define PALPATE_DEVICE_APPLIES_TORQUE 64u
#define PALPATE_DEVICE_REPORTS_ARMED 128u /* state.flags says whether forces are felt */

/* What a user does with a device: bits of palpate_device_state_v1.flags. */
#define PALPATE_DEVICE_ARMED 1u    /* the motors are on: a grip sensor or a pedal may switch them */
#define PALPATE_DEVICE_CLUTCHED 2u /* the tool shall stand still while the hand is moved back */

/* Later versions may add fields at the end of a struct: size is that of the struct as its owner
 * knows it. A driver writes fields that are marked as added only if size reaches their end. */
typedef struct palpate_device_info_v1 {
  uint32_t size;
  uint32_t capabilities;
  uint32_t joints;         /* number of joints, at most PALPATE_DEVICE_JOINTS */
  uint32_t reserved;       /* 0 */
  char name[64];           /* ends with a zero */
  double period;           /* [s] between two states */
  double highest_force;    /* [N] at the tip, for a moment */
  double continuous_force; /* [N] at the tip, continuously */
  /* Added, for playback; 0 is "not known" or "none". */
  double highest_torque;   /* [N mm] at the tip, for a moment */
  double damping;          /* [N s/mm] that the device alone has at least, along any direction */
  double delay;            /* [s] from a measurement until the force that answers it begins */
  double workspace_scale;  /* [mm/mm] of the object for one of the device */
  uint32_t buttons;        /* number of buttons, at most 32 */
  uint32_t clutch_buttons; /* bits of those that clutch */
  double friction;         /* [N] of dry friction that the device alone has at least */
  double resolution;       /* [mm] between two positions that the encoders tell apart, at most */
} palpate_device_info_v1;

typedef struct palpate_device_state_v1 {
  uint32_t size;
  uint32_t reserved;                    /* 0 */
  double time;                          /* [s] of the measurement, by the clock of now */
  double tip[3];                        /* [mm] */
  double joints[PALPATE_DEVICE_JOINTS]; /* [rad] */
  double force[3];                      /* [N] at the tip that the motors deliver, as measured */
  double heat[3]; /* of the motors, relative to that at which they must rest */
  /* Added: [N] on the object, by a force sensor under it or before the tip. It judges the device;
   * nothing that is commanded depends on it. */
  double reference_force[3];
  /* Added. */
  double velocity[3];    /* [mm/s] of the tip */
  double orientation[4]; /* unit quaternion w, x, y, z of the handle in the base's frame */
  uint32_t buttons;      /* bits of those that are pressed */
  uint32_t flags;        /* PALPATE_DEVICE_ARMED, PALPATE_DEVICE_CLUTCHED */
} palpate_device_state_v1;

typedef struct palpate_device_command_v1 {
  uint32_t size;
  uint32_t reserved; /* 0 */
  double force[3];   /* [N] of the motors at the tip */
  double lease;      /* [s] after which the device drops the force by itself if no command came */
  /* Added. */
  double torque[3]; /* [N mm] of the motors at the tip, with APPLIES_TORQUE */
} palpate_device_command_v1;

typedef struct palpate_device_v1 {
  uint32_t size;    /* sizeof(palpate_device_v1) */
  uint32_t version; /* PALPATE_DEVICE_VERSION */

  /* Connects to the device: motors off. Sets *device and fills *info. After a failure *device may
   * be null; last_error(null) then describes the failure. */
  int (*open)(void** device, palpate_device_info_v1* info);
  /* Sets an option of the driver, before activate. */
  int (*configure)(void* device, const char* key, const char* value);
  /* Arms the device: motors on, force 0; also while they are on. Nothing else arms it. */
  int (*activate)(void* device);
  /* Waits for the next state, for at most 20 periods. */
  int (*read)(void* device, palpate_device_state_v1* state);
  int (*write)(void* device, const palpate_device_command_v1* command);
  /* Motors off. At any time, more than once. */
  int (*stop)(void* device);
  void (*close)(void* device);
  /* The latest failure, until the next call. Never null. */
  const char* (*last_error)(void* device);
  /* [s] The clock of state.time. Null, as for hardware: CLOCK_MONOTONIC of the host. A simulation
   * may have its own, which stands still while nobody reads. */
  double (*now)(void* device);
  /* Several devices behind one driver: how many are there, and open for one of them, from 0. Null
   * for one device, or both given; open then opens the first. */
  uint32_t (*count)(void);
  int (*open_at)(uint32_t number, void** device, palpate_device_info_v1* info);
} palpate_device_v1;

typedef const palpate_device_v1* (*palpate_device_function)(void);

#ifdef __cplusplus
}
#endif

#endif
