// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

/// Options of LeakSanitizer for a program that draws and is built with AddressSanitizer: it does
/// not read the thread-local memory of threads, because it fails on that of the software renderer
/// ("Tracer caught signal 11"). Memory that only such memory refers to then counts as leaked.
// NOLINTNEXTLINE(bugprone-reserved-identifier): the name that LeakSanitizer looks for
extern "C" const char* __lsan_default_options() { return "use_tls=0"; }
