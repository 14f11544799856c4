"""Missions from Python are those of the commands, whole or step by step, looked into or not."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.commands import vedette
from vedette import run
from vedette.agent.events import Pose, Scan, Sensed
from vedette.maps import read_map
from vedette.outcome import Outcome
from vedette.record.explore.log import ExploreSnapshot
