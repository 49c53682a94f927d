"""The running machine as scripts see it: its status and the engine's commands."""
