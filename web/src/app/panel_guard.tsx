/** A failed panel affects no other, shows its error, and can be reloaded. The stack of the error is in the console and in the log. */

import { Component, type ReactNode } from "react";
import type { Page } from "../store/page/page.ts";
import { Empty } from "../ui/empty.tsx";
import { reportPanelError } from "./report_errors.ts";

interface PanelGuardProps {
  readonly name: string;
  readonly page: Pick<Page, "tell">;
  readonly children: ReactNode;
}

export class PanelGuard extends Component<PanelGuardProps, { readonly fault: string | null }> {
  override state = { fault: null };

  static getDerivedStateFromError(error: unknown) {
    return { fault: error instanceof Error ? error.message : String(error) };
  }

  override componentDidCatch(error: unknown) {
    reportPanelError(this.props.page, this.props.name, error);
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
