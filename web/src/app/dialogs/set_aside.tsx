/** Unsaved edits that the server could not restore: who made them, when and what, to repeat by hand, download or discard. */

import { Download, Trash2 } from "lucide-react";
import { useEffect, useState } from "react";
import type { SetAsideDraft } from "../../model/generated/protocol.ts";
import type { OpenTab } from "../../store/page/page.ts";
import { mayEdit } from "../../store/page/rights.ts";
import { RefusalError } from "../../store/page/server.ts";
import { Button } from "../../ui/button.tsx";
import { useConfirmPress } from "../../ui/confirm_press.ts";
import { Dialog } from "../../ui/dialog.tsx";
import { useComputed } from "../../ui/signals.ts";
import { useSession } from "../session_context.tsx";
import type { NamedDialogProps } from "./dialogs.tsx";

export function SetAside({ asks: tab, answer }: NamedDialogProps<"set-aside">) {
  const { page } = useSession();
  const path = `/machines/${encodeURIComponent(tab.session.id)}/set_aside`;
  const [drafts, setDrafts] = useState<readonly SetAsideDraft[] | null>(null);
  const [refusal, setRefusal] = useState<string | null>(null);
  useEffect(() => {
    page.server
      .request<readonly SetAsideDraft[]>("GET", path)
      .then(setDrafts, (error: unknown) => setRefusal(messageOf(error)));
  }, [page, path]);
  const discard = async (id: string) => {
    try {
      await page.server.request("DELETE", `${path}/${id}`);
    } catch (error) {
      setRefusal(messageOf(error));
      return;
    }
    const rest = drafts?.filter((draft) => draft.id !== id) ?? [];
    setDrafts(rest);
    if (rest.length === 0) answer(null);
  };
  return (
    <Dialog
      title="Edits set aside"
      width={640}
      onClose={() => answer(null)}
      footer={<Button onClick={() => answer(null)}>Close</Button>}
    >
      <p>
        The server could not restore these unsaved edits. Repeat those you need by hand, or download
        them, then discard them.
      </p>
      {refusal !== null && <p role="alert">{refusal}</p>}
      {drafts?.map((draft) => (
        <Draft
          key={draft.id}
          tab={tab}
          draft={draft}
          address={`/api/v1${path}/${draft.id}`}
          onDiscard={() => void discard(draft.id)}
        />
      ))}
    </Dialog>
  );
}

function messageOf(error: unknown): string {
  if (!(error instanceof RefusalError)) throw error;
  return error.message;
}

interface DraftProps {
  readonly tab: OpenTab;
  readonly draft: SetAsideDraft;
  readonly address: string;
  readonly onDiscard: () => void;
}

function Draft({ tab, draft, address, onDiscard }: DraftProps) {
  const { page } = useSession();
  const may = useComputed(() => mayEdit(page), [page]);
  const { asks, press } = useConfirmPress(onDiscard);
  const more = draft.count - draft.edits.length;
  return (
    <section className="set-aside">
      <p>{draft.reason}</p>
      <ol className="set-aside-edits">
        {draft.edits.map(({ author, at_ms, name, what }) => (
          <li key={`${at_ms} ${author} ${what}`}>
            <strong>{name}</strong>, {author}, {new Date(at_ms).toLocaleString()}:{" "}
            {tab.session.named(what)}
          </li>
        ))}
        {more > 0 && <li>and {more} more: see the download</li>}
      </ol>
      <div className="set-aside-actions">
        <a className="button button-plain" href={address} download="edits.json">
          <Download size={14} aria-hidden />
          Download
        </a>
        {may && (
          <Button kind={asks ? "danger" : "plain"} icon={<Trash2 size={14} />} onClick={press}>
            {asks ? "Discard for good?" : "Discard"}
          </Button>
        )}
      </div>
    </section>
  );
}
