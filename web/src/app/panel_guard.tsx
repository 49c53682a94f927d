/** A failed panel affects no other, shows its error, and can be reloaded. */

import { Component, type ReactNode } from "react";
import { Empty } from "../ui/empty.tsx";

interface PanelGuardProps {
  readonly name: string;
  readonly children: ReactNode;
}

export class PanelGuard extends Component<PanelGuardProps, { readonly fault: string | null }> {
  override state = { fault: null };

  static getDerivedStateFromError(error: unknown) {
    return { fault: error instanceof Error ? error.message : String(error) };
  }

  override render() {
    const { fault } = this.state;
    if (fault === null) return this.props.children;
    return (
      <Empty
        title={`${this.props.name} cannot be shown`}
        text={fault}
        action={{ title: "Show it again", onClick: () => this.setState({ fault: null }) }}
      />
    );
  }
}
