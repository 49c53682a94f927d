"""Sees all payloads of a fleet, and sends what it can make of them, as fast as it can, until its input ends."""

import json
import random
import sys
import threading

import zenoh

counts = {"down": 0, "up": 0, "readable": 0, "forged": 0}
seen = []


def note(sample):
    payload = bytes(sample.payload)
    direction = str(sample.key_expr).rsplit("/", 1)[-1]
    if payload not in own and direction in counts:
        counts[direction] += 1
        counts["readable"] += any(word in payload for word in (b"Waypoint", b"Mission", b"Search"))
        if len(seen) < 500:
            seen.append((direction, payload))


def flipped(payload):
    at = random.randrange(len(payload) * 8)
    changed = bytearray(payload)
    changed[at // 8] ^= 1 << (at % 8)
    return bytes(changed)


def forge():
    if not seen or random.random() < 0.3:
        return random.choice(["down", "up"]), random.randbytes(random.choice([0, 1, 28, 300, 1200, 60000]))
    direction, payload = random.choice(seen)
    # The same again, changed by a bit, or sent back.
    return random.choice([
        (direction, payload),
        (direction, flipped(payload)),
        ("up" if direction == "down" else "down", payload),
    ])


own = set()
ended = threading.Event()
threading.Thread(target=lambda: (sys.stdin.read(), ended.set()), daemon=True).start()
session = zenoh.open(zenoh.Config.from_json5(sys.argv[1]))
subscriber = session.declare_subscriber("rafcon/**", note)
while not ended.wait(0.0005):
    direction, payload = forge()
    own.add(payload)
    robot = "scout" if random.random() < 0.9 else f"robot{random.randrange(1000)}"
    session.put(f"rafcon/fleet/{robot}/{direction}", payload)
    counts["forged"] += 1
print(json.dumps(counts))
session.close()
