/** Yes or no, one of several, or a text. */

import { useState } from "react";
import { Button } from "../../ui/button.tsx";
import { Dialog } from "../../ui/dialog.tsx";
import { TextField } from "../../ui/field.tsx";
import type { UserQuestion } from "../question.ts";
import type { AskedDialogProps, NamedDialogProps } from "./dialogs.tsx";

export function Ask({ asks, answer }: NamedDialogProps<"question">) {
  switch (asks.kind) {
    case "confirm":
      return <Confirm asks={asks} answer={answer} />;
    case "choose":
      return <Choose asks={asks} answer={answer} />;
    case "prompt":
      return <Prompt asks={asks} answer={answer} />;
  }
}

function Confirm({
  asks,
  answer,
}: AskedDialogProps<UserQuestion & { kind: "confirm" }, string | boolean>) {
  return (
    <Dialog
      title={asks.title}
      onClose={() => answer(false)}
      footer={
        <>
          <Button onClick={() => answer(false)}>{asks.no ?? "Cancel"}</Button>
          <Button kind={asks.danger ? "danger" : "primary"} onClick={() => answer(true)}>
            {asks.yes}
          </Button>
        </>
      }
    >
      <p>{asks.text}</p>
    </Dialog>
  );
}

function Choose({
  asks,
  answer,
}: AskedDialogProps<UserQuestion & { kind: "choose" }, string | boolean>) {
  return (
    <Dialog
      title={asks.title}
      onClose={() => answer(null)}
      footer={<Button onClick={() => answer(null)}>Cancel</Button>}
    >
      <p>{asks.text}</p>
      {asks.list && (
        <ul className="ask-list">
          {asks.list.map((item) => (
            <li key={item}>{item}</li>
          ))}
        </ul>
      )}
      <div className="choices">
        {asks.choices.map(({ value, title, detail }) => (
          <button
            key={value}
            type="button"
            className="choice"
            data-safe={value === asks.safe || undefined}
            onClick={() => answer(value)}
          >
            <span className="choice-title">{title}</span>
            {detail && <span className="choice-detail">{detail}</span>}
          </button>
        ))}
      </div>
    </Dialog>
  );
}

function Prompt({
  asks,
  answer,
}: AskedDialogProps<UserQuestion & { kind: "prompt" }, string | boolean>) {
  const [text, setText] = useState(asks.initial ?? "");
  const [tried, setTried] = useState(false);
  const refusal = asks.check?.(text) ?? null;
  const done = () => {
    setTried(true);
    if (refusal === null) answer(text);
  };
  return (
    <Dialog
      title={asks.title}
      onClose={() => answer(null)}
      footer={
        <>
          <Button onClick={() => answer(null)}>Cancel</Button>
          <Button kind="primary" onClick={done}>
            OK
          </Button>
        </>
      }
    >
      <TextField
        label={asks.label}
        value={text}
        onInput={setText}
        autoFocus
        refusal={tried ? refusal : null}
        onKeyDown={(event) => event.key === "Enter" && done()}
      />
    </Dialog>
  );
}
