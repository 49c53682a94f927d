/** The server as the page has it: requests and the WebSocket of this browser. */

import { effect } from "@preact/signals-core";
import { REPEATED, RefusalError, type Server } from "../store/page/server.ts";
import { WALL_CLOCK } from "./clock.ts";
import { Delay } from "./delay.ts";
import { type Address, requests } from "./http.ts";
import { Socket, type Verdict, type Wire, type WireNews } from "./socket.ts";

/** Connects, and reconnects until `close`. */
export function connect(address: Address): Server & { readonly close: () => void } {
  const delay = new Delay();
  const { request, lines, askAgain } = requests(address, {
    clock: WALL_CLOCK,
    limit_ms: (isRepeated, bytes) => delay.request_ms(isRepeated, bytes),
    alive: () => socket.alive(),
    onResponse: (method, path, status) => {
      if (path !== "/session") {
        if (status === 401) socket.refuse("the server requires a login");
      } else if (method === "POST" && status === 200) socket.retry();
      else if (method === "DELETE" && status < 300) socket.refuse("you have logged out");
    },
  });
  const socket = new Socket({
    dial: (news) => dial(address, news),
    probe: () => probe(request),
    clock: WALL_CLOCK,
    delay,
    random: Math.random,
  });
  let wasDown = false;
  const back = effect(() => {
    const { state } = socket.link.value;
    if (state === "up" && wasDown) askAgain();
    wasDown = state === "down";
  });
  const deaf = onNetworkBack(() => socket.retry());
  return {
    link: socket.link,
    pulse: socket.pulse,
    request,
    lines,
    follow: (follower) => socket.follow(follower),
    onAnswer: (listener) => socket.onAnswer(listener),
    say: (frame) => socket.say(frame),
    retry: () => socket.retry(),
    close: () => {
      deaf();
      back();
      socket.close();
    },
  };
}

async function probe(request: Server["request"]): Promise<Verdict> {
  try {
    await request("GET", "/session", undefined, REPEATED);
  } catch (error) {
    const status = error instanceof RefusalError ? error.status : 0;
    return status === 401 ? "stranger" : "silent";
  }
  try {
    // This logs nobody in: the server checks the address of the page before it reads the body.
    await request("POST", "/session", {});
  } catch (error) {
    if (error instanceof RefusalError && error.code === "wrong_origin") {
      return { turnedAway: error.message };
    }
  }
  return "welcome";
}

function dial({ url, token }: Address, news: WireNews): Wire {
  const base = url === "" ? location.origin : url;
  const query = token ? `?token=${encodeURIComponent(token)}` : "";
  const socket = new WebSocket(`${base.replace(/^http/, "ws")}/api/v1/socket${query}`);
  socket.onmessage = ({ data }) => news.text(String(data));
  socket.onerror = () => news.closed("the connection was lost");
  socket.onclose = ({ reason }) => news.closed(reason === "" ? "the connection was lost" : reason);
  return { send: (text) => socket.send(text), close: () => socket.close() };
}

/** The browser reports a network, or that the page is visible again. */
function onNetworkBack(back: () => void): () => void {
  if (typeof window === "undefined") return () => {};
  const seen = () => document.visibilityState === "visible" && back();
  window.addEventListener("online", back);
  document.addEventListener("visibilitychange", seen);
  return () => {
    window.removeEventListener("online", back);
    document.removeEventListener("visibilitychange", seen);
  };
}
