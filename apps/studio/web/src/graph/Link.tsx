// A link between nodes. From far all of them are drawn into one picture: hundreds of small ones are what browsers are slow at.
import { BezierEdge, getBezierPath, type EdgeProps } from "@xyflow/react";
import { createContext, useContext } from "react";
import { createPortal } from "react-dom";

/** Where links are drawn while the graph is seen from far; null while it is not. */
export const FarLinks = createContext<SVGSVGElement | null>(null);

export function Link(props: EdgeProps) {
  const far = useContext(FarLinks);
  if (!far) return <BezierEdge {...props} />;
  const name = `react-flow__edge ${props.selected ? "selected" : ""} ${(props.data as { className: string }).className}`;
  return createPortal(<g className={name}><path className="react-flow__edge-path" d={getBezierPath(props)[0]} style={props.style} /></g>, far);
}
