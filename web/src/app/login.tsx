/** Login of a user. */

import { useState } from "react";
import { RefusalError } from "../store/page/server.ts";
import { Button } from "../ui/button.tsx";
import { TextField } from "../ui/field.tsx";
import { useSession } from "./session_context.tsx";
import "./login.css";

export function Login({ reason }: { reason: string }) {
  const { page } = useSession();
  const [user, setUser] = useState("");
  const [password, setPassword] = useState("");
  const [refusal, setRefusal] = useState<string | null>(null);
  const [waits, setWaits] = useState(false);
  const enter = async () => {
    setWaits(true);
    setRefusal(null);
    try {
      await page.server.request("POST", "/session", { user, password });
      page.server.retry();
    } catch (error) {
      setRefusal(error instanceof RefusalError ? error.message : String(error));
    } finally {
      setWaits(false);
    }
  };
  return (
    <main className="login">
      <form
        className="login-card"
        onSubmit={(event) => {
          event.preventDefault();
          void enter();
        }}
      >
        <h1 className="login-title">RAFCON</h1>
        <p className="login-text">{sentence(reason)}</p>
        <TextField label="User" value={user} onInput={setUser} autoFocus autoComplete="username" />
        <TextField
          label="Password"
          type="password"
          value={password}
          onInput={setPassword}
          autoComplete="current-password"
          refusal={refusal}
        />
        <button type="submit" className="button button-primary" disabled={waits || user === ""}>
          Log in
        </button>
        <p className="login-hint">
          The link that <code>rafcon serve</code> prints logs its owner in without a password.
          Create other users with <code>rafcon user add NAME --role engineer</code>.
        </p>
      </form>
    </main>
  );
}

function sentence(text: string): string {
  return `${text.slice(0, 1).toUpperCase()}${text.slice(1)}.`;
}

export function Unreachable({ reason }: { reason: string }) {
  const { page } = useSession();
  return (
    <main className="login">
      <div className="login-card">
        <h1 className="login-title">RAFCON</h1>
        <p className="login-text">{reason}</p>
        <Button kind="primary" onClick={() => page.server.retry()}>
          Try again now
        </Button>
      </div>
    </main>
  );
}
