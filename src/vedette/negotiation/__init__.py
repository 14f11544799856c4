"""How a team agrees on strategies by messages on a tree."""

from vedette.negotiation.asynchronous import AsyncNode
from vedette.negotiation.chooser import Chooser
from vedette.negotiation.fork import ForkNode
from vedette.negotiation.jacobi import JacobiNode
from vedette.negotiation.messages import Message, RoundOutcome, decode, encode
from vedette.negotiation.negotiate import Negotiation, Step, negotiate
from vedette.negotiation.node import Claims, Negotiator, Outgoing, Participant
from vedette.negotiation.schemes import SCHEMES, node_of
from vedette.negotiation.token import TokenNode
from vedette.negotiation.tree import Tree

__all__ = [
    "SCHEMES",
    "AsyncNode",
    "Chooser",
    "Claims",
    "ForkNode",
    "JacobiNode",
    "Message",
    "Negotiation",
    "Negotiator",
    "Outgoing",
    "Participant",
    "RoundOutcome",
    "Step",
    "TokenNode",
    "Tree",
    "decode",
    "encode",
    "negotiate",
    "node_of",
]
