"""Take certificates back: make the list that tells a team whose count no more."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from vedette.errors import InputError
from vedette.maps.atomic import atomic_path
from vedette.net.keys import last_number, load_authority
from vedette.net.names import check_team, robot_name
from vedette.net.revoked import REVOKED, load_revoked, put_beside_keys, signed
from vedette.number import many


def revoke(team: str, folder: Path | str, robots: Sequence[int], now: datetime) -> Path:
    """Revoke the certificates of some robots of an authority, by index; return the list of all such.

    It never loses a robot, and is put into the folder of every holder that is still there. ``now`` has a time
    zone.

    Raises:
        InputError: no robot, or one that was never issued; ``folder`` holds no authority of this team, or
            cannot be written.
    """
    folder = Path(folder)
    authority = load_authority(folder, check_team(team), now)
    before = load_revoked(folder, authority.certificate, team)
    last = last_number(folder)
    if not robots:
        raise InputError("whose certificate? give the numbers of robots, such as 2")
    if strange := [robot for robot in robots if not 0 <= robot < last]:
        raise InputError(
            f"{robot_name(strange[0])} was never issued; team {team!r} has {many(last, 'robot')}"
        )
    listed = signed(team, before.number + 1, before.robots | set(robots), authority.key)
    with atomic_path(folder / REVOKED) as part:
        part.write_bytes(listed.text)
    put_beside_keys(folder)
    return folder / REVOKED
