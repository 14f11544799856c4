"""What a mission leaves: figures, logs, MCAP records, pictures, live views.

An observer measures a mission from views of its robots, in this process or from afar, and adds snapshots to
a log, which forwards them to its sinks while the mission goes on and feeds the pictures afterwards. What is
said of one kind of mission alone lies in ``explore``, ``track`` and ``search``.
"""
