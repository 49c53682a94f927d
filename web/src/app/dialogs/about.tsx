/** Version and licence. */

import { Dialog } from "../../ui/dialog.tsx";
import { useSignal } from "../../ui/signals.ts";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

export function About({ answer }: NamedDialogProps<"about">) {
  const { page } = useSession();
  const link = useSignal(page.server.link);
  return (
    <Dialog title="RAFCON" width={420} onClose={() => answer(null)}>
      <div className="form">
        <p>
          Hierarchical, concurrent state machines for robots: drawn, run and watched in one place.
        </p>
        {link.state === "up" && (
          <p>
            Server {link.session.version}. You are {link.session.user}, {link.session.role}.
          </p>
        )}
      </div>
    </Dialog>
  );
}
