// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0

// Plays a trace through the C library by P/Invoke, as Unity and Godot do. PlayTrace FOLDER, which tests/web/make_page.py has
// filled; the library is found as libpalpate_c.so in LD_LIBRARY_PATH.
using System;
using System.Globalization;
using System.IO;
using System.Runtime.InteropServices;

static class Palpate {
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct Tick {
    public uint structSize;
    public int state;
    public fixed double force[3];
    public fixed double contact[3];
  }

  [DllImport("palpate_c")] static extern IntPtr palpate_error_text();
  [DllImport("palpate_c")] public static extern int palpate_model_open(string folder, out IntPtr model);
  [DllImport("palpate_c")] public static extern void palpate_model_close(IntPtr model);
  [DllImport("palpate_c")] public static extern int palpate_player_create(IntPtr model, IntPtr options, out IntPtr player);
  [DllImport("palpate_c")] public static extern void palpate_player_destroy(IntPtr player);
  [DllImport("palpate_c")]
  public static extern int palpate_player_step(IntPtr player, double[] tool, double seconds, ref Tick tick);

  public static void Check(int status) {
    if (status != 0) throw new Exception(Marshal.PtrToStringAnsi(palpate_error_text()));
  }
}

static class PlayTrace {
  const double Difference = 1e-9;  // [mm], [N]: Mono reads some decimal numbers wrong by the last bit
  static bool Agree(double a, double b) { return Math.Abs(a - b) <= Difference; }

  static unsafe int Main(string[] words) {
    IntPtr model, player;
    Palpate.Check(Palpate.palpate_model_open(Path.Combine(words[0], "model"), out model));
    Palpate.Check(Palpate.palpate_player_create(model, IntPtr.Zero, out player));
    Palpate.palpate_model_close(model);
    var states = new[] {"free", "stick", "slip"};
    var tick = new Palpate.Tick {structSize = (uint)sizeof(Palpate.Tick)};
    int ticks = 0, different = 0;
    foreach (string row in File.ReadAllLines(Path.Combine(words[0], "trace.csv"))) {
      string[] cells = row.Split(',');
      if (cells[0] == "t") continue;
      Func<int, double> number = (i) => double.Parse(cells[i], CultureInfo.InvariantCulture);
      var tool = new[] {number(1), number(2), number(3)};
      Palpate.Check(Palpate.palpate_player_step(player, tool, 1e-3, ref tick));
      bool same = states[tick.state] == cells[10];
      for (int i = 0; i < 3; ++i) same &= Agree(tick.contact[i], number(4 + i)) && Agree(tick.force[i], number(7 + i));
      ++ticks;
      if (!same && different++ == 0) {
        Console.WriteLine("tick {0}: state {1} for {2}, contact {3:R}, force {4:R}", ticks, states[tick.state], row, tick.contact[2], tick.force[2]);
      }
    }
    Palpate.palpate_player_destroy(player);
    Console.WriteLine("{0} ticks, {1} differ", ticks, different);
    return different == 0 && ticks > 1000 ? 0 : 1;
  }
}
