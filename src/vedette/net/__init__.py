"""Robots as processes: sessions over Eclipse Zenoh, and the keys that admit them."""

from vedette.net.access import Access
from vedette.net.credentials import Credentials, credentials
from vedette.net.inbox import Inbox, PeerGone, PeerSeen, ReceivedDatagram
from vedette.net.names import Topic
from vedette.net.transport import Operator, Published, Transport

__all__ = [
    "Access",
    "Credentials",
    "Inbox",
    "Operator",
    "PeerGone",
    "PeerSeen",
    "Published",
    "ReceivedDatagram",
    "Topic",
    "Transport",
    "credentials",
]
