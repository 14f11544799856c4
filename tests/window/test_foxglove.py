"""Foxglove's protocol, spoken by hand: the record's messages come with their types, and orders go back."""

from __future__ import annotations

import json
import struct
import time
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

from tests.support.windows import FRAME, SCENE, snapshot
from vedette.agent.orders import LookThere, Order, Pause
from vedette.errors import InputError
from vedette.record.explore.mcap import ExploreMcapWriter
from vedette.window.foxglove import CLICKED, ORDER, TOKEN, FoxgloveServer, order_in

pytest.importorskip("foxglove")
STORE = get_typestore(Stores.ROS2_HUMBLE)


def told(client: ClientConnection, wanted: str) -> dict[str, Any]:
    """Take what comes until a message of an operation does."""
    while True:
        message = client.recv(timeout=10.0)
        if isinstance(message, str) and (said := json.loads(message))["op"] == wanted:
            return dict(said)


def data_of(client: ClientConnection, subscription: int) -> bytes:
    """Take what comes until data of a subscription does."""
    while True:
        message = client.recv(timeout=10.0)
        if isinstance(message, bytes) and message[0] == 1:
            (number, _) = struct.unpack_from("<IQ", message, 1)
            if number == subscription:
                return message[13:]


def test_the_map_comes_as_a_ros_message_and_an_order_goes_back() -> None:
    given: list[Order] = []
    server = FoxgloveServer(
        "hall", lambda order: given.append(order) or "taken by scout", ExploreMcapWriter, port=0
    )
    with server:
        server.show(SCENE, snapshot(1.0))
        address = f"ws://127.0.0.1:{server.port}"
        with connect(address, subprotocols=[Subprotocol("foxglove.sdk.v1")]) as client:
            channels: dict[str, dict[str, Any]] = {}
            while "/map" not in channels or "/scout/pose" not in channels:
                channels |= {each["topic"]: each for each in told(client, "advertise")["channels"]}
            chosen = channels["/map"]
            assert chosen["schemaName"] == "nav_msgs/msg/OccupancyGrid"
            assert chosen["encoding"] == "cdr"
            subscribe = {"op": "subscribe", "subscriptions": [{"id": 7, "channelId": chosen["id"]}]}
            client.send(json.dumps(subscribe))
            end = time.monotonic() + 10.0
            while server._writer is not None and time.monotonic() < end:
                time.sleep(0.02)  # until the server has heard of it
            server.show(SCENE, snapshot(2.0))
            grid = STORE.deserialize_cdr(data_of(client, 7), chosen["schemaName"])
            assert (grid.info.height, grid.info.width) == FRAME.shape
            assert np.count_nonzero(np.asarray(grid.data) == 0) == 3 * (FRAME.rows - 1)
            advertise = [
                {"id": k, "topic": topic, "encoding": "json", "schemaName": "std_msgs/msg/String"}
                for k, topic in ((1, ORDER), (2, TOKEN))
            ]
            client.send(json.dumps({"op": "advertise", "channels": advertise}))
            pause = b'{"data": "{\\"order\\": \\"pause\\", \\"robot\\": 2}"}'
            token = json.dumps({"data": server.token}).encode()
            told_in_turn = (
                (1, pause, "refused: publish the token"),
                (2, b'{"data": "guessed"}', "refused: the token is wrong"),
                (2, b"[]", "refused: "),
                (1, pause, "refused: publish the token"),
                (2, token, "the token is right"),
                (1, pause, "taken by scout"),
                (1, b'{"order": "explode"}', "refused: "),
                (1, b"[", "refused: "),
            )
            for channel, text, _ in told_in_turn:
                client.send(struct.pack("<BI", 1, channel) + text)
            end = time.monotonic() + 10.0
            while len(server.answers) < len(told_in_turn) and time.monotonic() < end:
                time.sleep(0.02)
    assert given == [Pause(robot=2)]
    for answer, (*_, words) in zip(server.answers, told_in_turn, strict=True):
        assert answer.startswith(words)


def test_a_clicked_point_is_a_place_to_look_at() -> None:
    message = {"header": {"frame_id": "map"}, "point": {"x": 1.5, "y": 2.0, "z": 0.0}}
    assert order_in(CLICKED, json.dumps(message).encode()) == LookThere(at=(1.5, 2.0))
    assert order_in(ORDER, b'{"order": "pause"}') == Pause()
    with pytest.raises(InputError, match="unknown order 'fly'"):
        order_in(ORDER, b'{"order": "fly"}')
