"""How much of the cores other programs take meanwhile: what makes a figure noisy."""

import os
import time


class Meter:
    """Started when made; `others()` says what share of the cores' time went to other processes since."""

    def __init__(self):
        self.cores = sorted(os.sched_getaffinity(0))
        self.start = self.read()

    def read(self):
        ticks = os.sysconf("SC_CLK_TCK")
        with open("/proc/stat") as file:
            lines = {fields[0]: fields for fields in map(str.split, file)}
        # user, nice, system, idle, iowait, irq, softirq, steal
        busy = sum(sum(int(lines[f"cpu{core}"][i]) for i in (1, 2, 3, 6, 7, 8)) for core in self.cores) / ticks
        own = os.times()
        return time.monotonic(), busy, own.user + own.system + own.children_user + own.children_system

    def others(self):
        """0 to 1; none where the system does not say."""
        seconds, busy, own = (now - then for now, then in zip(self.read(), self.start))
        return min(1.0, max(0.0, busy - own) / (seconds * len(self.cores)))
