"""Measures the programs in rounds: all of them draw the same views within a round, so what disturbs the machine hits all alike.

Views lie `step` degrees apart on an orbit; round r holds the views r (frames + 1) to r (frames + 1) + frames, of which the first
warms cellfan's process up and is not counted. VTK stays in one process and warms up before the first round.
"""

from dataclasses import dataclass, field

import vtk_peer


@dataclass
class Measured:
    """`rounds_ms`: a list a round; `pictures`: view to picture, of the first round."""

    rounds_ms: list = field(default_factory=list)
    pictures: dict = field(default_factory=dict)
    warm_up_ms: float = None
    stats: dict = None


@dataclass(frozen=True)
class Plan:
    rounds: int
    frames: int
    step_degrees: float
    slow_ms: float  # a peer whose frame takes longer draws one a round, and one in all where it takes ten times as long

    def view(self, camera, number):
        return camera.orbited(number * self.step_degrees)

    def counted(self, number):
        """The views of a round that count."""
        first = number * (self.frames + 1) + 1
        return range(first, first + self.frames)


def measure(plan, camera, grid, transfer, peers, threads, draw_cellfan, say):
    """Name to [`Measured`], cellfan's included. `draw_cellfan(camera, frames)` is one process of it."""
    measured = {name: Measured() for name in [*peers, "cellfan"]}
    windows = {}
    for name in peers:
        windows[name] = vtk_peer.Peer(vtk_peer.PEERS[name].make(threads), grid, transfer, (camera.width, camera.height))
        measured[name].warm_up_ms = windows[name].frame(plan.view(camera, -1))
        say(f"{name}: first frame {measured[name].warm_up_ms:,.0f} ms")
    frames_of = {name: plan.frames for name in peers}
    for number in range(plan.rounds):
        # Nobody is always first.
        for name in list(measured)[:: 1 if number % 2 == 0 else -1]:
            if name == "cellfan":
                draw_round_of_cellfan(plan, camera, number, draw_cellfan, measured[name])
            else:
                draw_round(plan, camera, number, windows[name], frames_of, name, measured[name])
            say(f"round {number + 1}, {name}: " + (", ".join(f"{ms:,.0f}" for ms in measured[name].rounds_ms[-1]) or "no") + " ms")
    for window in windows.values():
        window.close()
    return measured


def draw_round(plan, camera, number, window, frames_of, name, measured):
    times = []
    if number > 0 and measured.rounds_ms[0][0] > 10 * plan.slow_ms:
        measured.rounds_ms.append(times)
        return
    for view in plan.counted(number)[: frames_of[name]]:
        times.append(window.frame(plan.view(camera, view)))
        if number == 0:
            measured.pictures[view] = window.picture()
        if times[-1] > plan.slow_ms:
            frames_of[name] = 1
            break
    measured.rounds_ms.append(times)


def draw_round_of_cellfan(plan, camera, number, draw_cellfan, measured):
    views = plan.counted(number)
    run = draw_cellfan(plan.view(camera, views[0] - 1), plan.frames + 1)
    measured.rounds_ms.append(run.frames_ms[1:])
    measured.stats = run.stats
    if number == 0:
        measured.pictures = dict(zip(views, run.pictures[1:]))
