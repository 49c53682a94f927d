/** The folders and machines of all projects, as a tree that gets what is inside when it is opened. */

import { Folder, FolderOpen, Workflow } from "lucide-react";
import { useEffect, useMemo, useState } from "react";
import type { FileNode, MachineFile, Project } from "../model/generated/protocol.ts";
import { Empty } from "../ui/empty.tsx";
import { useSignal } from "../ui/signals.ts";
import { Tree } from "../ui/tree.tsx";
import { useSession } from "./session_context.tsx";

/** A project, folder or machine. */
export interface ProjectNode {
  readonly file: MachineFile;
  readonly name: string;
  readonly kind: "project" | "folder" | "machine";
  readonly children: readonly ProjectNode[] | null;
}

/** Content of a project in a tree. */
export function projectNode(project: Project, root: FileNode | undefined): ProjectNode {
  const children = root?.children?.map((child) => nodeOf(project.id, child)) ?? [];
  return { file: { project: project.id, path: "" }, name: project.name, kind: "project", children };
}

function nodeOf(project: string, { name, path, kind, children }: FileNode): ProjectNode {
  const inside = kind === "machine" ? null : (children ?? []).map((one) => nodeOf(project, one));
  return { file: { project, path }, name, kind, children: inside };
}

/** Only what has the text in its path, and what is around it. */
export function filtered(nodes: readonly ProjectNode[], text: string): readonly ProjectNode[] {
  const wanted = text.trim().toLowerCase();
  if (wanted === "") return nodes;
  return nodes.flatMap((node) => {
    if (node.kind !== "project" && node.file.path.toLowerCase().includes(wanted)) return [node];
    const children = filtered(node.children ?? [], wanted);
    return children.length > 0 ? [{ ...node, children }] : [];
  });
}

export function nodeKey({ file }: ProjectNode): string {
  return `${file.project}/${file.path}`;
}

/** The trees of all projects, updated when files change; null until they are loaded. */
export function useProjects(): readonly ProjectNode[] | null {
  const { page } = useSession();
  const projects = useSignal(page.projects);
  const revision = useSignal(page.serverStatus)?.files_revision;
  const [nodes, setNodes] = useState<readonly ProjectNode[] | null>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another revision means other files
  useEffect(() => {
    let wanted = true;
    const ask = async (project: Project) =>
      projectNode(
        project,
        await page.server.request<FileNode>(
          "GET",
          `/projects/${encodeURIComponent(project.id)}/tree`,
        ),
      );
    Promise.all(projects.map(ask)).then(
      (found) => wanted && setNodes(found),
      (error: unknown) =>
        page.tell({ level: "error", text: `The projects could not be read: ${String(error)}` }),
    );
    return () => {
      wanted = false;
    };
  }, [page, projects, revision]);
  return nodes;
}

interface ProjectTreeProps {
  readonly nodes: readonly ProjectNode[];
  readonly search?: string;
  readonly selected: MachineFile | null;
  /** Has the keyboard first in the tree, and is brought into sight. */
  readonly first?: MachineFile | null;
  readonly onSelect: (node: ProjectNode) => void;
  readonly onOpen: (node: ProjectNode) => void;
  /** Kind of a folder. */
  readonly note?: (node: ProjectNode) => string | null;
}

export function ProjectTree(props: ProjectTreeProps) {
  const { nodes, search = "", selected, first, onSelect, onOpen, note } = props;
  const [folded, setFolded] = useState<ReadonlySet<string>>(new Set());
  const roots = useMemo(() => filtered(nodes, search), [nodes, search]);
  const expanded = useMemo(() => openKeys(roots, folded), [roots, folded]);
  if (roots.length === 0) {
    return search === "" ? (
      <Empty
        title="No projects"
        text={
          <>
            Machines are stored in projects: folders that you pass to the server, as in{" "}
            <code>rafcon serve FOLDER</code>.
          </>
        }
      />
    ) : (
      <Empty title="Nothing found" text={`No folder or machine name contains “${search}”.`} />
    );
  }
  return (
    <Tree
      label="Projects"
      roots={roots}
      id={nodeKey}
      childrenOf={childrenOf}
      text={({ name }) => name}
      expanded={expanded}
      selected={new Set(selected ? [`${selected.project}/${selected.path}`] : [])}
      reveal={first ? `${first.project}/${first.path}` : null}
      onExpand={(node, open) =>
        setFolded((before) => {
          const next = new Set(before);
          if (open) next.delete(nodeKey(node));
          else next.add(nodeKey(node));
          return next;
        })
      }
      onSelect={onSelect}
      onOpen={onOpen}
      row={(node) => (
        <>
          <NodeRow node={node} open={expanded.has(nodeKey(node))} />
          {note?.(node) && <span className="tree-note">{note(node)}</span>}
        </>
      )}
    />
  );
}

const childrenOf = (node: ProjectNode) => node.children;

/** All folders but those that the user folded. */
function openKeys(nodes: readonly ProjectNode[], folded: ReadonlySet<string>): ReadonlySet<string> {
  const open = new Set<string>();
  const add = (node: ProjectNode) => {
    if (!folded.has(nodeKey(node))) open.add(nodeKey(node));
    node.children?.forEach(add);
  };
  nodes.forEach(add);
  return open;
}

function NodeRow({ node, open }: { node: ProjectNode; open: boolean }) {
  if (node.kind === "machine") {
    return (
      <>
        <Workflow size={14} className="tree-icon tree-icon-machine" aria-hidden />
        {node.name}
      </>
    );
  }
  const Icon = open ? FolderOpen : Folder;
  return (
    <>
      <Icon size={14} className="tree-icon" aria-hidden />
      {node.name}
    </>
  );
}
