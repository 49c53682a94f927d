"""What a state consists of: outcomes, data ports, transitions, data flows, scoped variables."""
