"""Errands as a navigator answers them: every order of answers, and what each means for the robot."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import pytest

from vedette.agent.events import Arrived, Stuck
from vedette.ros2.goals import AGAIN, ANSWER, REJECTED, UNMOVED, ActionStatus, Ask, Cancel, Errands

HERE, THERE, ELSEWHERE = (0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (0.0, 3.0, 0.0)


def sent(goals: Errands) -> list[Ask | Cancel]:
    orders, goals.orders = goals.orders, []
    return orders


def told(goals: Errands) -> list[Arrived | Stuck]:
    outcomes, goals.outcomes = goals.outcomes, []
    return outcomes


def driving() -> Errands:
    goals = Errands()
    goals.want(THERE, 0.0)
    goals.accepted(1, 0.1)
    assert sent(goals) == [Ask(1, THERE)]
    return goals


@pytest.mark.parametrize(
    ("status", "outcomes"),
    [
        (ActionStatus.SUCCEEDED, [Arrived()]),
        (ActionStatus.ABORTED, [Stuck()]),
        (ActionStatus.CANCELED, [Stuck()]),
        (ActionStatus.EXECUTING, []),
        (ActionStatus.CANCELING, []),
        (ActionStatus.UNKNOWN, []),
    ],
)
def test_each_status_of_the_present_goal_means_one_thing(
    status: ActionStatus, outcomes: list[object]
) -> None:
    goals = driving()
    goals.status(1, status, 1.0)
    goals.status(1, status, 1.1)  # told twice, as by the topic and with the result
    assert told(goals) == outcomes
    assert sent(goals) == []


def test_a_newer_goal_takes_the_place_of_the_one_before_and_its_end_means_nothing() -> None:
    goals = driving()
    goals.want(ELSEWHERE, 1.0)
    assert sent(goals) == [Ask(2, ELSEWHERE)]
    goals.status(1, ActionStatus.ABORTED, 1.1)
    goals.accepted(2, 1.2)
    goals.status(1, ActionStatus.ABORTED, 1.3)
    assert told(goals) == []
    goals.status(2, ActionStatus.SUCCEEDED, 5.0)
    assert told(goals) == [Arrived()]


def test_where_the_robot_is_going_already_it_is_not_sent_again() -> None:
    goals = driving()
    goals.want(THERE, 1.0)
    goals.want((2.01, 0.0, 1.0), 2.0, facing=False)
    assert sent(goals) == []
    goals.want((2.0, 0.0, 1.0), 3.0)  # there, but facing another way
    assert sent(goals) == [Ask(2, (2.0, 0.0, 1.0))]


def test_a_place_that_was_reached_is_asked_for_again_if_it_is_wanted_again() -> None:
    goals = driving()
    goals.status(1, ActionStatus.SUCCEEDED, 3.0)
    goals.want(THERE, 3.1)
    assert sent(goals) == [Ask(2, THERE)]


def test_a_robot_that_need_not_face_anywhere_is_there_before_it_stands_and_goes_on_without_a_halt() -> None:
    goals, near = Errands(), (1.9, 0.1, 2.0)
    goals.want(THERE, 0.0, facing=False)
    goals.accepted(1, 0.1)
    goals.tick((1.7, 0.0, 2.0), 3.0)
    assert told(goals) == []
    goals.tick(near, 3.1)
    goals.tick(near, 3.2)
    goals.status(1, ActionStatus.EXECUTING, 3.3)
    assert (told(goals), sent(goals)) == ([Arrived()], [Ask(1, THERE)])
    goals.want(ELSEWHERE, 3.4, facing=False)
    assert sent(goals) == [Ask(2, ELSEWHERE)]  # which ends the other
    goals.status(1, ActionStatus.ABORTED, 3.5)
    assert told(goals) == []


def test_a_robot_that_is_there_is_held_back_from_its_last_touch_if_it_is_to_stand() -> None:
    goals = Errands()
    goals.want(THERE, 0.0, facing=False)
    goals.accepted(1, 0.1)
    goals.tick((1.9, 0.1, 2.0), 3.1)
    goals.want(None, 3.2)
    assert sent(goals) == [Ask(1, THERE), Cancel(1)]
    goals.want(THERE, 4.0, facing=False)
    goals.accepted(2, 4.1)
    goals.tick((1.9, 0.1, 2.0), 4.2)
    goals.status(2, ActionStatus.SUCCEEDED, 5.0)
    goals.want(None, 6.0)
    assert sent(goals) == [Ask(2, THERE)]  # nothing runs that could be cancelled
    assert told(goals) == [Arrived(), Arrived()]


def test_a_robot_that_is_to_face_somewhere_is_there_when_the_navigator_says_so() -> None:
    goals = driving()
    goals.tick((1.99, 0.0, 2.0), 3.1)
    assert told(goals) == []


def test_a_status_before_the_answer_is_an_answer() -> None:
    goals = Errands()
    goals.want(THERE, 0.0)
    goals.status(1, ActionStatus.EXECUTING, 0.1)
    assert goals.driving
    goals.tick(HERE, ANSWER + 1.0)
    assert told(goals) == []


def test_standing_cancels_what_runs_and_its_end_means_nothing() -> None:
    goals = driving()
    goals.want(None, 1.0)
    assert sent(goals) == [Cancel(1)]
    goals.status(1, ActionStatus.CANCELED, 1.1)
    goals.want(None, 2.0)
    assert (told(goals), sent(goals)) == ([], [])


def test_a_goal_that_is_taken_up_when_nobody_wants_it_any_more_is_cancelled() -> None:
    goals = Errands()
    goals.want(THERE, 0.0)
    goals.want(None, 0.1)
    sent(goals)
    goals.accepted(1, 0.2)
    assert sent(goals) == [Cancel(1)]


def test_a_navigator_that_is_not_active_yet_is_asked_again_until_it_is() -> None:
    goals, now, asked = Errands(), 0.0, 0
    goals.want(THERE, now)
    while now < 20.0:
        for order in sent(goals):
            asked += 1
            assert isinstance(order, Ask)
            goals.rejected(order.goal, now)
        now += 0.1
        goals.tick(HERE, now)
    assert told(goals) == []
    assert asked == pytest.approx(20.0 / AGAIN, abs=2)
    goals.tick(HERE, now + AGAIN)
    (order,) = sent(goals)
    goals.accepted(order.goal, now + AGAIN)
    goals.status(order.goal, ActionStatus.SUCCEEDED, now + 5.0)
    assert told(goals) == [Arrived()]


def test_a_navigator_that_rejects_for_ever_leaves_the_robot_stuck() -> None:
    goals, now = Errands(), 0.0
    goals.want(THERE, now)
    while not goals.outcomes and now < 2.0 * REJECTED:
        for order in sent(goals):
            goals.rejected(order.goal, now)
        now += 0.5
        goals.tick(HERE, now)
    assert told(goals) == [Stuck()]
    assert now == pytest.approx(REJECTED, abs=1.0)
    assert "rejected" in goals.said


def test_a_goal_that_is_never_answered_leaves_the_robot_stuck_and_is_cancelled_in_case_it_was_heard() -> None:
    goals = Errands()
    goals.want(THERE, 0.0)
    goals.tick(HERE, ANSWER - 0.1)
    assert told(goals) == []
    goals.tick(HERE, ANSWER)
    assert told(goals) == [Stuck()]
    assert sent(goals) == [Ask(1, THERE), Cancel(1)]
    goals.accepted(1, ANSWER + 1.0)
    assert sent(goals) == [Cancel(1)]


def test_a_robot_that_does_not_move_is_stuck_and_one_that_moves_or_turns_is_not() -> None:
    moves: list[Callable[[float], tuple[float, float, float]]] = [
        lambda t: (0.05 * t, 0.0, 0.0),
        lambda t: (0.0, 0.0, 0.1 * t),
        lambda t: HERE,
    ]
    ended = []
    for at in moves:
        goals, now = driving(), 0.1
        while now < 2.0 * UNMOVED and not goals.outcomes:
            now += 0.1
            goals.tick(at(now), now)
        ended.append(told(goals))
        if ended[-1]:
            assert sent(goals) == [Cancel(1)]
        else:
            assert goals.slowed < UNMOVED / 2
    assert ended == [[], [], [Stuck()]]


def test_a_navigator_that_dies_and_comes_back_is_sent_to_the_same_place_again() -> None:
    goals = driving()
    goals.gone(1.0)
    goals.tick(HERE, 1.0 + AGAIN)
    assert sent(goals) == [Ask(2, THERE)]
    goals.accepted(2, 4.0)
    goals.status(2, ActionStatus.SUCCEEDED, 9.0)
    assert told(goals) == [Arrived()]


def test_whatever_is_said_in_whatever_order_one_want_has_at_most_one_outcome() -> None:
    """All sequences of five of what can happen; each want is answered once at most, and nothing raises."""
    acts: dict[str, Callable[[Errands, float], None]] = {
        "accepted": lambda g, t: g.accepted(1, t),
        "rejected": lambda g, t: g.rejected(1, t),
        "succeeded": lambda g, t: g.status(1, ActionStatus.SUCCEEDED, t),
        "aborted": lambda g, t: g.status(1, ActionStatus.ABORTED, t),
        "canceled": lambda g, t: g.status(1, ActionStatus.CANCELED, t),
        "late": lambda g, t: g.accepted(0, t),
        "gone": lambda g, t: g.gone(t),
        "stand": lambda g, t: g.want(None, t),
        "long": lambda g, t: g.tick(HERE, t + REJECTED),
        "there": lambda g, t: g.tick(THERE, t),
    }
    for names in product(acts, repeat=5):
        goals = Errands()
        goals.want(THERE, 0.0, facing=False)
        for step, name in enumerate(names):
            acts[name](goals, 0.1 * step)
        assert len(goals.outcomes) <= 1, names
        if "stand" in names and not any(
            n in ("succeeded", "aborted", "canceled", "long", "there") for n in names[: names.index("stand")]
        ):
            assert goals.outcomes == [], names
        if goals.wanted is None:
            assert not goals.driving, names
