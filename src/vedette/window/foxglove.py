"""A mission live in Foxglove: the record's messages over its WebSocket, and orders by what it publishes."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self, cast

import msgspec

from vedette.agent.orders import Order
from vedette.errors import InputError
from vedette.record.log import Sink
from vedette.record.mcap import Medium, Place
from vedette.scenario import as_scenario

ORDER, CLICKED, TOKEN = "/order", "/clicked_point", "/token"  # topics that Foxglove may publish on
MOST = 4096  # bytes of what it publishes
LOOPBACK, PORT = "127.0.0.1", 8765


class _Said(msgspec.Struct, frozen=True):
    order: Order


class FoxgloveServer:
    """Serves messages by ``foxglove-sdk`` for as long as it is entered; ``vedette.record.mcap.Medium``."""

    def __init__(
        self,
        name: str,
        give: Callable[[Order], str] | None,
        recorder: Callable[[Place | Medium, Any], Sink[Any]],
        port: int = PORT,
    ) -> None:
        """Prepare to serve on this computer alone.

        Args:
            name: of what is served.
            give: an order, and what has come of it; None: nobody can be told anything.
            recorder: tells a scene's snapshots to a medium.
            port: to listen on; 0: any.

        Raises:
            InputError: foxglove-sdk is not installed.
        """
        try:
            import foxglove
        except ImportError:
            raise InputError("foxglove-sdk is missing: pip install 'vedette[foxglove]'") from None
        self._sdk, self._name, self._give, self._port = foxglove, name, give, port
        self._recorder = recorder
        self.token = secrets.token_urlsafe(18)
        self._trusted = set[int]()  # clients that have told the token
        self._channels: list[Any] = []
        self._by_topic: dict[str, int] = {}
        self._schemas: list[Any] = []
        self._topics: dict[tuple[int, int], str] = {}  # of what clients publish, by client and channel
        self.answers: list[str] = []  # to orders, oldest first
        self._scene: Any = None
        self._writer: Sink[Any] | None = None

    def __enter__(self) -> Self:
        """Begin to serve.

        Raises:
            InputError: the port cannot be listened on.
        """
        can = [self._sdk.Capability.ClientPublish] if self._give else []
        try:
            self._server = self._sdk.start_server(
                name=self._name,
                host=LOOPBACK,
                port=self._port,
                capabilities=can,
                server_listener=cast(Any, self),  # it has what is used of a listener
                supported_encodings=["json"],
            )
        except Exception as error:  # the SDK's own kinds
            raise InputError(f"cannot listen on {LOOPBACK}:{self._port}: {error}") from error
        self.port = self._server.port
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop."""
        self._server.stop()

    def show(self, scene: Any, snapshot: Any) -> None:
        """Send a snapshot's messages; grids whenever the scene has changed, and as often as a record's."""
        if self._writer is None or (scene is not self._scene and scene != self._scene):
            self._scene, self._writer = scene, self._recorder(self, scene)
        self._writer.update(snapshot)

    # -- what is sent: Medium --------------------------------------------------------------------------

    def register_schema(self, name: str, encoding: str, data: bytes) -> int:
        """Take a message type; return its number."""
        self._schemas.append(self._sdk.Schema(name=name, encoding=encoding, data=data))
        return len(self._schemas) - 1

    def register_channel(self, topic: str, message_encoding: str, schema_id: int) -> int:
        """Take a topic, or one that there is already; return its number."""
        if topic not in self._by_topic:
            schema = self._schemas[schema_id]
            self._channels.append(self._sdk.Channel(topic, schema=schema, message_encoding=message_encoding))
            self._by_topic[topic] = len(self._channels) - 1
        return self._by_topic[topic]

    def add_message(
        self, channel_id: int, log_time: int, data: bytes, publish_time: int, sequence: int = 0
    ) -> None:
        """Send a message; times [ns]."""
        self._channels[channel_id].log(data, log_time=log_time)

    # -- what is heard: the SDK's listener, in its own threads --------------------------------------------

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """Note what a client will publish on."""
        self._topics[client.id, channel.id] = channel.topic

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        """Forget it."""
        self._topics.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        """Take an order that a client publishes; one that makes no sense is answered, and changes nothing.

        The SDK neither asks who connects nor tells whence: a page in this computer's browser can. So orders
        count of clients alone that have told the token, which stands where the window's address does.
        """
        topic = self._topics.get((client.id, client_channel_id))
        if self._give is None or topic not in (ORDER, CLICKED, TOKEN) or len(data) > MOST:
            return
        try:
            if topic == TOKEN:
                answer = self._trust(client.id, data)
            elif client.id not in self._trusted:
                answer = f"refused: publish the token on {TOKEN} first, as a std_msgs/String"
            else:
                answer = self._give(order_in(topic, data))
        except (InputError, ValueError, TypeError, KeyError) as error:
            answer = f"refused: {error}"
        self.answers.append(answer)
        self._server.publish_status(answer, self._sdk.StatusLevel.Info)

    def _trust(self, client: int, data: bytes) -> str:
        """Take a client's word for the token."""
        told = msgspec.json.decode(data)["data"]
        if not secrets.compare_digest(str(told).encode(), self.token.encode()):
            return "refused: the token is wrong"
        self._trusted.add(client)
        return "the token is right: orders are taken"

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Send the map anew to whoever begins to look."""
        self._writer = None

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Go on."""


def order_in(topic: str, data: bytes) -> Order:
    """Return the order in what Foxglove publishes as JSON: one's own words, or a point to look at.

    Raises:
        InputError: it is no order.
        ValueError, TypeError, KeyError: it is no such message.
    """
    message = msgspec.json.decode(data)
    if topic == CLICKED:
        point = message["point"]
        message = {"order": "look", "at": [float(point["x"]), float(point["y"])]}
    elif isinstance(message.get("data"), str):  # a std_msgs/String
        message = msgspec.json.decode(message["data"])
    return as_scenario({"order": message}, _Said, "order").order
