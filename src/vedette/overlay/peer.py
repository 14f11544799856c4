"""One neighbour: what was heard from it, whether the link to it can be used, and when to say hello again."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field

from vedette.overlay.clock import ClockFilter
from vedette.overlay.hello import ASK, BYE, TICKS, TWICE, UP, Echo, Hello
from vedette.overlay.stamp import Stamp

HELLOS_A_LEASE = 3
FIRST_RESEND = 0.1  # of news that the neighbour has not confirmed, doubling up to the hello period [s]
QUIET = 0.4  # of the lease: a neighbour silent for longer is asked to answer
PROBE = 0.25  # between hellos that ask [s]
FIRST_HOLD, MOST_HOLD = 1.0, 10.0  # for which a link that failed is left alone, doubling [s]
SETTLED = 30.0  # a link that was up for so long starts with the first hold again [s]
FIRST_SHUN, MOST_SHUN = 10.0, 160.0  # for which a neighbour is shunned, doubling [s]
SMOOTHING = 0.1  # of the loss estimate, a hello
MOST_MISSED = 8  # hellos that one gap counts for: silence is the lease's business
NOWHERE = Stamp(0, 0, 0)  # below all others
COSTS = ((0.0, 0.0, 1), (0.15, 0.08, 2), (0.45, 0.3, 4))  # loss to enter a class, to leave it; hops it counts


@dataclass(eq=False)
class Peer:
    """One robot's view of one neighbour."""

    robot: int
    lease: float
    terms: int  # what this robot takes the team to agree on, as a fingerprint
    reachable: bool = True  # the transport can send to it
    boot: int = -1  # -1: never heard
    hello: Hello | None = None  # the latest
    stamp: Stamp = NOWHERE  # of the tree that it is on
    since: float = 0.0  # when that stamp was first heard [s]
    heard: float = -float("inf")  # when anything was [s]
    greeted: float = -float("inf")  # when the latest hello was [s]
    up: bool = False  # we would use the link
    outdone: bool = False  # a tree of its has been, since the link came up
    twice: int | None = None  # boot of another process under this number, started later
    twice_heard: float = -float("inf")  # when it was [s]
    loss: float = 0.0  # share of its hellos that do not arrive
    due: float = 0.0  # the next hello to it [s]
    sent: int = 0  # hellos
    clock: ClockFilter = field(default_factory=ClockFilter)
    _level: int = 0  # of COSTS
    _up_since: float = 0.0
    _hold: float = 0.0
    _shun: float = FIRST_SHUN / 2
    _trusted: float = -float("inf")  # when the link may be used again
    _past: deque[int] = field(default_factory=lambda: deque(maxlen=8))  # its earlier boots
    _restarted: int = 0  # our hellos to it before its present life
    _last_sent: float = -float("inf")
    _sent_at: dict[int, float] = field(default_factory=dict)  # the latest hellos
    _told: int = 1  # the hello from which on all news is in
    _tries: int = 0

    # -- hearing -----------------------------------------------------------------------------------

    def is_news(self, hello: Hello, now: float) -> bool:
        """Tell whether a hello is neither a copy, nor overtaken, nor from an earlier life of the robot.

        Nor from a process started later under the number of one that lives.
        """
        if hello.boot == self.twice:
            self.twice_heard = now
            return now >= self.greeted + self.lease
        if hello.boot != self.boot:
            return hello.boot not in self._past
        return self.hello is None or hello.sequence > self.hello.sequence

    def take(self, hello: Hello, own_boot: int, now: float) -> None:
        """Take in a hello that is news."""
        if hello.boot != self.boot:
            self._restart(hello.boot, now)
        before, self.hello = self.hello, hello
        if before is not None:
            self._count(min(hello.sequence - before.sequence - 1, MOST_MISSED), hello.loss / 100)
        if hello.stamp != self.stamp or before is None:
            self.stamp, self.since = hello.stamp, now
        self.heard = -float("inf") if hello.flags & BYE else now
        self.greeted = now
        self._take_times(hello, own_boot, now)
        # Whoever has something new to say, or asks, is answered: it repeats itself until then.
        if hello.flags & ASK or before is None or _content(before) != _content(hello):
            self.due = now

    def is_double(self, now: float) -> bool:
        """Tell whether another process under this number has been heard lately."""
        return now < self.twice_heard + self.lease

    def refuse_the_younger(self, hello: Hello, own_boot: int, now: float) -> None:
        """Keep to the process that was started first, if two are alive under this number.

        An earlier life that has heard what was said since the later one came is none: it goes on. Boots grow
        from start to start.
        """
        echo = hello.echo
        lives = echo is not None and echo.boot == own_boot and self._restarted < echo.sequence <= self.sent
        if hello.boot in self._past and lives:
            older, self.twice = min(hello.boot, self.boot), max(hello.boot, self.boot)
            self.twice_heard = now
            if older != self.boot:
                self._restart(older, now)

    def _restart(self, boot: int, now: float) -> None:
        if self.boot >= 0:
            self._past.append(self.boot)
        if boot in self._past:
            self._past.remove(boot)
        if boot == self.twice:
            self.twice, self.twice_heard = None, -float("inf")
        self._restarted = self.sent
        self.boot, self.hello, self.loss = boot, None, 0.0
        self.clock = ClockFilter()
        self._go_down(now)

    def _count(self, missed: int, loss_there: float) -> None:
        self.loss = 1 - (1 - self.loss) * (1 - SMOOTHING) ** missed
        self.loss *= 1 - SMOOTHING
        worse = max(self.loss, loss_there)
        while self._level + 1 < len(COSTS) and worse > COSTS[self._level + 1][0]:
            self._level += 1
        while worse < COSTS[self._level][1]:
            self._level -= 1

    def _take_times(self, hello: Hello, own_boot: int, now: float) -> None:
        echo = hello.echo
        if echo is None or echo.boot != own_boot or echo.sequence not in self._sent_at:
            return
        left = hello.time / TICKS
        self.clock.take(self._sent_at[echo.sequence], left - echo.hold / TICKS, left, now)

    # -- judging the link --------------------------------------------------------------------------

    @property
    def cost(self) -> int:
        """Return what the link adds to the distance to the root: more than 1 where hellos are lost."""
        return COSTS[self._level][2]

    @property
    def said_goodbye(self) -> bool:
        """Tell whether the latest it said is that it leaves."""
        return self.hello is not None and bool(self.hello.flags & BYE)

    @property
    def usable(self) -> bool:
        """Tell whether both ends would use the link."""
        return self.up and self.hello is not None and bool(self.hello.flags & UP)

    def judge(self, own_boot: int, now: float) -> None:
        """Decide whether to use the link: both ends hear each other, and it has not failed just now.

        One that failed has to be heard anew: what came before says nothing of a link that comes and goes.
        """
        hello = self.hello
        two_way = hello is not None and hello.echo is not None and hello.echo.boot == own_boot
        agrees = hello is not None and hello.terms == self.terms
        fresh = self._trusted <= self.heard and now < self.heard + self.lease
        up = self.reachable and two_way and agrees and fresh
        if up and not self.up:
            self.up, self._up_since, self.outdone = True, now, False
            self.tell(now)
        elif self.up and not up:
            self._go_down(now)
        if self.up and now >= self.heard + QUIET * self.lease:
            self.due = min(self.due, self._last_sent + PROBE)

    def _go_down(self, now: float) -> None:
        if self.up:
            again = now < self._up_since + SETTLED
            self._hold = min(max(2 * self._hold, FIRST_HOLD), MOST_HOLD) if again else FIRST_HOLD
            self._trusted = now + self._hold
            self.up = False
            self.tell(now)

    def is_doubted(self, now: float) -> bool:
        """Tell whether it was shunned, and has not been good for long since."""
        return self._shun >= FIRST_SHUN and not (self.up and now >= self._up_since + SETTLED)

    def shun(self, now: float) -> None:
        """Leave the link alone for a while, however well it works; one that was good for long, anew."""
        again = now < self._up_since + SETTLED + 2 * self._shun
        self._go_down(now)
        self._shun = min(2 * self._shun, MOST_SHUN) if again else FIRST_SHUN
        self._trusted = max(self._trusted, now + self._shun)

    def forget(self) -> None:
        """Count the neighbour as silent from now on, until it is heard again."""
        self.heard = -float("inf")

    def wake(self, now: float) -> float:
        """Return when time alone will next change something here [s]."""
        due = self.due if self.reachable else float("inf")
        if self.up:
            probe = max(self.heard + QUIET * self.lease, self._last_sent + PROBE)
            return min(due, probe, self.heard + self.lease)
        return due

    # -- speaking ----------------------------------------------------------------------------------

    def tell(self, at: float) -> None:
        """Say hello at a time [s], and again and again until the neighbour has confirmed what is new now."""
        self._told, self._tries = self.sent + 1, 0
        self.due = at

    def next_hello(self, own_boot: int, now: float) -> tuple[int, int, Echo | None]:
        """Return sequence number, flags and echo of a hello that leaves now."""
        self.sent += 1
        self._last_sent = self._sent_at[self.sent] = now
        self._sent_at.pop(self.sent - 16, None)
        echo = self.hello.echo if self.hello else None
        confirmed = echo is not None and echo.boot == own_boot and echo.sequence >= self._told
        asks = self.up and now >= self.heard + QUIET * self.lease
        pause = self.lease / HELLOS_A_LEASE
        if not confirmed:
            pause = min(pause, FIRST_RESEND * 2**self._tries)
            self._tries = min(self._tries + 1, 8)
        self.due = now + (min(pause, PROBE) if asks else pause)
        heard = self.hello is not None and now < self.heard + self.lease
        flags = (UP if self.up else 0) | (ASK if asks else 0) | (TWICE if self.is_double(now) else 0)
        return self.sent, flags, self._echo(now) if heard else None

    def _echo(self, now: float) -> Echo | None:
        assert self.hello
        return Echo(self.boot, self.hello.sequence, round((now - self.greeted) * TICKS))


def _content(hello: Hello) -> tuple[object, ...]:
    """What a neighbour says that wants an answer."""
    return hello.stamp, hello.distance, hello.flags & ~ASK, hello.echo is None
