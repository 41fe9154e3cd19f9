// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

/// Part of each program that is built with AddressSanitizer: libraries stay loaded when they are
/// closed. LeakSanitizer reports at the end of a process, and can neither name nor suppress what
/// was allocated by a library that has been unloaded by then, such as the driver of OpenGL.
/// Weak, because a program may get this object from several of our libraries.
extern "C" __attribute__((weak)) int dlclose(void* /*module*/) { return 0; }
