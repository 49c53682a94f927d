/** Questions of commands to the user. */

export type UserQuestion =
  | {
      readonly kind: "confirm";
      readonly title: string;
      readonly text: string;
      readonly yes: string;
      readonly no?: string;
      readonly danger?: boolean;
    }
  | {
      readonly kind: "choose";
      readonly title: string;
      readonly text: string;
      /** Items below the text. */
      readonly list?: readonly string[];
      /** The choice that loses nothing, which has the focus; null: only *Cancel* is safe. */
      readonly safe: string | null;
      readonly choices: readonly {
        readonly value: string;
        readonly title: string;
        readonly detail?: string;
      }[];
    }
  | {
      readonly kind: "prompt";
      readonly title: string;
      readonly label: string;
      readonly initial?: string;
      readonly check?: (text: string) => string | null;
    };
